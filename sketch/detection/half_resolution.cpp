// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/half_resolution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "sketch/detection/weighted_rows.hpp"

namespace emberfold::sketch {

namespace {

// A pixel's place in the frame along one side: every second, or between two.
struct Side {
  int size;
  bool odd;

  explicit Side(int of) : size((of + 1) / 2), odd(of % 2 == 1) {}
};

// Weights of the place itself and of the pairs of pixels about it that make a Gaussian of this variance.
std::vector<float> make_weights(const Side& side, double variance) {
  constexpr double kReach = 3;  // SD
  std::vector<double> weights{side.odd ? 1.0 : 0.0};
  double sum = weights[0];
  for (int i = 1; i == 1 || i <= kReach * std::sqrt(variance); ++i) {
    const double away = side.odd ? i : i - 0.5;
    const double w = variance > 0 ? std::exp(-0.5 * away * away / variance) : side.odd ? 0 : 1;
    weights.push_back(w);
    sum += 2 * w;
  }
  std::vector<float> shares;
  for (const double w : weights) shares.push_back(static_cast<float>(w / sum));
  return shares;
}

// The level smoothed by a Gaussian, at half the resolution; with a border of one pixel as the level's own.
cv::Mat1f halve(const cv::Mat1f& from, double variance) {
  const cv::Size frame(from.cols - 2, from.rows - 2);
  const Side across(frame.width), down(frame.height);
  const std::vector<float> row_weights = make_weights(across, variance),
                           weights = make_weights(down, variance);
  const int reach = static_cast<int>(row_weights.size()), taps = static_cast<int>(weights.size());
  std::vector<float> row(static_cast<std::size_t>(frame.width + 2 * reach)), smooth(row.size());
  float* const middle = row.data() + reach;
  std::vector<const float*> before, after;
  cv::Mat1f to(down.size + 2, across.size + 2);
  const auto mirrored = [](int at, int size) { return cv::borderInterpolate(at, size, cv::BORDER_REFLECT); };
  for (int y = 0; y < down.size; ++y) {
    before.clear(), after.clear();
    for (int i = 0; i < taps; ++i) {
      before.push_back(from[mirrored(2 * y - i + (down.odd || i == 0 ? 0 : 1), frame.height) + 1] + 1);
      after.push_back(from[mirrored(2 * y + i, frame.height) + 1] + 1);
    }
    weigh_rows(before.data(), after.data(), weights.data(), taps, frame.width, middle);
    for (int x = 1; x <= reach; ++x) {
      middle[-x] = middle[mirrored(-x, frame.width)];
      middle[frame.width - 1 + x] = middle[mirrored(frame.width - 1 + x, frame.width)];
    }
    before.clear(), after.clear();
    for (int i = 0; i < reach; ++i) {
      before.push_back(middle - i + (across.odd || i == 0 ? 0 : 1));
      after.push_back(middle + i);
    }
    weigh_rows(before.data(), after.data(), row_weights.data(), reach, frame.width, smooth.data());
    float* out = to[y + 1];
    for (int x = 0; x < across.size; ++x) out[x + 1] = smooth[static_cast<std::size_t>(2 * x)];
    out[0] = out[1], out[across.size + 1] = out[across.size];
  }
  to.row(1).copyTo(to.row(0));
  to.row(down.size).copyTo(to.row(down.size + 1));
  return to;
}

// A step's or line's strength, σ^{1/2}·slope or σ^{3/2}·bend, in pixels twice as large.
constexpr double kStrength = std::numbers::sqrt2;

int halved_size(int size) {
  return (size + 1) / 2;
}

}  // namespace

HalfResolution::HalfResolution(cv::Size frame)
    : right_(frame.width % 2 == 0 ? 1 : 0),
      below_(frame.height % 2 == 0 ? 1 : 0),
      first_{0.5 * right_, 0.5 * below_} {}

FramePart HalfResolution::halved(const FramePart& part) {
  const cv::Size frame(halved_size(part.frame.width), halved_size(part.frame.height));
  const auto end = [](int at, int size) { return at == size ? halved_size(size) : at / 2; };
  const cv::Point last(end(part.core.br().x, part.frame.width), end(part.core.br().y, part.frame.height));
  return {frame, {part.origin.x / 2, part.origin.y / 2}, {{part.core.x / 2, part.core.y / 2}, last}};
}

ScaleSpace HalfResolution::halved(const ScaleSpace& space) const {
  ScaleSpace half;
  for (const ScaleLevel& level : space) {
    half.push_back(level);
    ScaleLevel& to = half.back();
    to.sigma *= 0.5, to.gradient_sd *= 2, to.hessian_sd *= 4;
    to.frame.release(), to.smooth.release();
    if (level.channel != 0) continue;
    // Differences of larger pixels average already: no smoothing before them.
    constexpr double kDifferences = 1;  // px², about: found with curves that people drew
    const bool finest = level.octave == 0;
    to.smooth =
        finest ? halve(level.smooth, 0)
               : halve((&level - 1)->smooth, std::max(0.0, 0.5 * level.sigma * level.sigma - kDifferences));
  }
  return half;
}

CreasePoint HalfResolution::halved(const CreasePoint& point) const {
  CreasePoint half = point;
  half.position = (point.position - first_) * 0.5;
  half.strength *= kStrength;
  return half;
}

Chain HalfResolution::to_frame(const Chain& chain) const {
  Chain whole{chain.kind, {}, chain.closed};
  whole.points.reserve(2 * chain.points.size());
  const auto add = [&](CreasePoint point, graph::Point at) {
    point.position = at * 2 + first_;
    point.strength /= kStrength;
    whole.points.push_back(point);
  };
  const std::size_t n = chain.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const CreasePoint& here = chain.points[i];
    add(here, here.position);
    if (i + 1 == n && !chain.closed) break;
    const CreasePoint& next = chain.points[(i + 1) % n];
    add(here.significance < next.significance ? here : next, (here.position + next.position) * 0.5);
  }
  return whole;
}

}  // namespace emberfold::sketch
