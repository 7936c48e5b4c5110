// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/amplitude.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include <opencv2/core/hal/intrin.hpp>

#include "sketch/patches/profile_shape.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kStep = 0.5;                               // px between samples across
constexpr std::array kSamples{-2.5, -1.25, 0., 1.25, 2.5};  // px, samples along
constexpr double kLeastSide = 3, kMostSide = 12;            // px to each side
constexpr double kOfSlip = 0.02;           // of the amplitude, what a px of slip has to be worth
constexpr double kLeastDifference = 1e-3;  // grey levels

/// The weights of the channels that make the patch's own difference of levels 1.
std::array<double, 3> project_colours(const Patch& patch, int channels) {
  std::array<double, 3> weights{};
  double square = 0;
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
    const double left = double{patch.left[c]}, right = double{patch.right[c]};
    weights[c] = on_step(patch) ? right - left : double{patch.middle[c]} - 0.5 * (left + right);
    square += weights[c] * weights[c];
  }
  for (double& w : weights) w /= std::max(square, kLeastDifference * kLeastDifference);
  return weights;
}

/// The places of a profile's samples: rows along the patch, side by side.
struct Raster {
  Point middle, along, across;
  [[nodiscard]] Point at(int row, double s) const { return middle + across * (row * kStep) + along * s; }
};

template <class T>
double sample(const cv::Mat& levels, Point p, const std::array<double, 3>& weights) {
  const double x = std::clamp(p.x, 0.0, levels.cols - 1.0), y = std::clamp(p.y, 0.0, levels.rows - 1.0);
  const int left = static_cast<int>(x), top = static_cast<int>(y), channels = levels.channels();
  const int right = std::min(left + 1, levels.cols - 1), bottom = std::min(top + 1, levels.rows - 1);
  const double u = x - left, v = y - top;
  const auto *above = levels.ptr<T>(top), *below = levels.ptr<T>(bottom);
  double sum = 0;
  for (int c = 0; c < channels; ++c) {
    const auto at = [&](const T* row, int column) { return static_cast<double>(row[column * channels + c]); };
    sum +=
        weights[static_cast<std::size_t>(c)] * ((1 - v) * ((1 - u) * at(above, left) + u * at(above, right)) +
                                                v * ((1 - u) * at(below, left) + u * at(below, right)));
  }
  return sum;
}

/// Four numbers in a row.
cv::v_float32x4 load_four(const float* from) {
  return cv::v_load(from);
}
cv::v_float32x4 load_four(const std::uint8_t* from) {
  std::uint32_t four = 0;
  std::memcpy(&four, from, sizeof four);  // OpenCV's own load takes them to be aligned
  const cv::v_uint16x8 pairs = cv::v_expand_low(cv::v_reinterpret_as_u8(cv::v_setall_u32(four)));
  return cv::v_cvt_f32(cv::v_reinterpret_as_s32(cv::v_expand_low(pairs)));
}

/// The mean of a row's samples. Near the border its levels go on.
template <class T>
double row_mean(const cv::Mat& levels, const Raster& raster, int row, const std::array<double, 3>& weights) {
  double sum = 0;
  for (const double s : kSamples) sum += sample<T>(levels, raster.at(row, s), weights);
  return sum / static_cast<double>(kSamples.size());
}

/// The same for three channels off the border: all at once.
template <class T>
double inner_row_mean(const cv::Mat& levels, const Raster& raster, int row,
                      const std::array<double, 3>& weights) {
  const std::size_t stride = levels.step1();
  cv::v_float32x4 sum = cv::v_setzero_f32();
  for (const double s : kSamples) {
    const Point p = raster.at(row, s);
    const int left = static_cast<int>(p.x), top = static_cast<int>(p.y);
    const cv::v_float32x4 u = cv::v_setall_f32(static_cast<float>(p.x - left)),
                          v = cv::v_setall_f32(static_cast<float>(p.y - top));
    const T *const above = levels.ptr<T>(top) + 3 * left, *const below = above + stride;
    const cv::v_float32x4 upper = load_four(above), lower = load_four(below);
    const cv::v_float32x4 over = cv::v_muladd(u, load_four(above + 3) - upper, upper),
                          under = cv::v_muladd(u, load_four(below + 3) - lower, lower);
    sum += cv::v_muladd(v, under - over, over);
  }
  std::array<float, 4> sums{};
  cv::v_store(sums.data(), sum);
  return (weights[0] * double{sums[0]} + weights[1] * double{sums[1]} + weights[2] * double{sums[2]}) /
         static_cast<double>(kSamples.size());
}

/// Returns whether all samples, up to `rows` rows to each side, have pixels around them and one to the right.
bool is_inner(const cv::Mat& levels, const Raster& raster, int rows) {
  for (const int row : {-rows, rows})
    for (const double s : {kSamples.front(), kSamples.back()}) {
      const Point p = raster.at(row, s);
      if (!(p.x >= 0 && p.y >= 0 && p.x < levels.cols - 2 && p.y < levels.rows - 1)) return false;
    }
  return true;
}

/// The frame's levels across a patch, `rows` rows to each side.
template <class T>
std::vector<double> levels_across(const cv::Mat& levels, const Patch& patch, int rows) {
  const Point along{std::cos(patch.theta), std::sin(patch.theta)};
  const Raster raster{patch.position, along, {-along.y, along.x}};
  const auto weights = project_colours(patch, levels.channels());
  const bool at_once = levels.channels() == 3 && is_inner(levels, raster, rows);
  std::vector<double> seen;
  seen.reserve(static_cast<std::size_t>(2 * rows) + 1);
  for (int row = -rows; row <= rows; ++row)
    seen.push_back(at_once ? inner_row_mean<T>(levels, raster, row, weights)
                           : row_mean<T>(levels, raster, row, weights));
  return seen;
}

/// A patch's profile `half` rows to each side, less its mean: so it is orthogonal to a constant level.
std::vector<double> profile_across(const Patch& patch, const ProfileShape& shape, int half) {
  std::vector<double> profile(static_cast<std::size_t>(2 * half) + 1);
  const auto middle = static_cast<std::size_t>(half);
  double mean = 0;
  for (std::size_t i = 0; i <= middle; ++i) {
    const auto reached = shape.at(static_cast<double>(i) * kStep);
    const bool is_step = on_step(patch);
    const double value = is_step ? reached.enter : reached.enter - reached.leave;
    profile[middle + i] = value;
    profile[middle - i] = is_step ? 1 - value : value;
  }
  for (const double p : profile) mean += p;
  mean /= static_cast<double>(profile.size());
  for (double& p : profile) p -= mean;
  return profile;
}

}  // namespace

Amplitude measure_amplitude(const cv::Mat& levels, const Patch& patch, double slip) {
  const ProfileShape shape(patch);
  const double reach = std::clamp(shape.half_width + 2 * shape.blur, kLeastSide, kMostSide) + 1;
  const int half = static_cast<int>(reach / kStep), slips = static_cast<int>(slip / kStep);
  const auto seen = levels.depth() == CV_8U ? levels_across<std::uint8_t>(levels, patch, half + slips)
                                            : levels_across<float>(levels, patch, half + slips);
  const auto profile = profile_across(patch, shape, half);
  double square = 0;
  for (const double p : profile) square += p * p;
  Amplitude best{-std::numeric_limits<double>::infinity(), 0};
  for (int shift = -slips; shift <= slips; ++shift) {
    double product = 0;
    for (std::size_t i = 0; i < profile.size(); ++i)
      product += profile[i] * seen[i + static_cast<std::size_t>(slips + shift)];
    const double value = product / square - kOfSlip * kStep * std::abs(shift);
    if (value > best.value) best = {value, kStep * shift};
  }
  return best;
}

}  // namespace emberfold::sketch
