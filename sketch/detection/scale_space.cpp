// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/scale_space.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "sketch/detection/weighted_rows.hpp"

namespace emberfold::sketch {

namespace {

cv::Mat1d gaussian_kernel(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  return cv::getGaussianKernel(2 * radius + 1, sigma, CV_64F);
}

// Sum of squares of a 1-D kernel after convolving it with `difference`: the gain of white noise's variance.
double noise_gain(const cv::Mat1d& kernel, std::initializer_list<double> difference) {
  const std::vector<double> d(difference);
  const int n = kernel.rows, m = static_cast<int>(d.size());
  double sum = 0;
  for (int i = 0; i < n + m - 1; ++i) {
    double v = 0;
    for (int j = 0; j < m; ++j)
      if (i - j >= 0 && i - j < n) v += d[static_cast<std::size_t>(j)] * kernel(i - j, 0);
    sum += v * v;
  }
  return sum;
}

struct Bilinear {
  int x, y;
  double fx, fy;
};

Bilinear locate(graph::Point p, int width, int height) {
  const double x = std::clamp(p.x, 0.0, width - 1.0), y = std::clamp(p.y, 0.0, height - 1.0);
  const int ix = std::min(static_cast<int>(x), std::max(width - 2, 0)),
            iy = std::min(static_cast<int>(y), std::max(height - 2, 0));
  return {ix, iy, x - ix, y - iy};
}

}  // namespace

Hessian ScaleLevel::hessian_at(graph::Point p) const {
  const int width = smooth.cols - 2, height = smooth.rows - 2;
  const Bilinear b = locate(p, width, height);
  const int x1 = std::min(b.x + 1, width - 1), y1 = std::min(b.y + 1, height - 1);
  const float *row = smooth[b.y], *end = smooth[y1];
  const auto stride = static_cast<std::ptrdiff_t>(smooth.step1());
  const auto at = [stride](const float* up) { return hessian_of(up, up + stride, up + 2 * stride); };
  const Hessian h00 = at(row + b.x), h10 = at(row + x1), h01 = at(end + b.x), h11 = at(end + x1);
  const auto mix = [&](float v00, float v10, float v01, float v11) {
    return static_cast<float>((1 - b.fy) * ((1 - b.fx) * double{v00} + b.fx * double{v10}) +
                              b.fy * ((1 - b.fx) * double{v01} + b.fx * double{v11}));
  };
  return {mix(h00.xx, h10.xx, h01.xx, h11.xx), mix(h00.xy, h10.xy, h01.xy, h11.xy),
          mix(h00.yy, h10.yy, h01.yy, h11.yy)};
}

double ScaleLevel::value_at(graph::Point p) const {
  const Bilinear b = locate(p, smooth.cols - 2, smooth.rows - 2);
  const float* upper = smooth[b.y + 1] + b.x + 1;
  const float* lower = smooth[b.y + 2] + b.x + 1;
  return (1 - b.fy) * ((1 - b.fx) * double{upper[0]} + b.fx * double{upper[1]}) +
         b.fy * ((1 - b.fx) * double{lower[0]} + b.fx * double{lower[1]});
}

namespace {

// A symmetric kernel's middle and its taps to one side, `apart` px from one to the next.
struct Taps {
  int apart = 1;
  std::vector<float> weight;
  [[nodiscard]] int reach() const { return apart * (static_cast<int>(weight.size()) - 1); }
};

// An image that is smooth to `smoothed` px has hardly any power at the frequencies that taps farther apart
// alias to. At taps n px apart the kernel repeats every 2π/n; there the product of both is below e⁻¹².
Taps gaussian_taps(double sigma, double smoothed) {
  Taps taps;
  taps.apart = std::max(1, static_cast<int>(0.886 * std::min(sigma, smoothed)));
  const int count = std::max(1, static_cast<int>(std::ceil(4 * sigma / taps.apart)));
  double sum = 0;
  std::vector<double> weight;
  for (int i = 0; i <= count; ++i) {
    weight.push_back(std::exp(-0.5 * std::pow(i * taps.apart / sigma, 2)));
    sum += (i > 0 ? 2 : 1) * weight.back();
  }
  for (const double w : weight) taps.weight.push_back(static_cast<float>(w / sum));
  return taps;
}

// Mirrored at the frame's border, the border's pixel twice.
int mirrored(int at, int size) {
  at %= 2 * size;
  if (at < 0) at += 2 * size;
  return at < size ? at : 2 * size - 1 - at;
}

// The frame `from` (its first pixel at `border`, `border`) smoothed, with a border of one pixel.
cv::Mat1f smoothed(const cv::Mat1f& from, int border, const Taps& taps) {
  const int width = from.cols - 2 * border, height = from.rows - 2 * border, reach = taps.reach();
  const auto count = taps.weight.size();
  cv::Mat1f to(height + 2, width + 2);
  std::vector<float> row(static_cast<std::size_t>(width + 2 * reach));
  std::vector<const float*> before(count), after(count);
  for (int y = 0; y < height; ++y) {
    for (std::size_t i = 0; i < count; ++i) {
      const int away = taps.apart * static_cast<int>(i);
      before[i] = from[mirrored(y - away, height) + border] + border;
      after[i] = from[mirrored(y + away, height) + border] + border;
    }
    float* middle = row.data() + reach;
    weigh_rows(before.data(), after.data(), taps.weight.data(), static_cast<int>(count), width, middle);
    for (int x = 1; x <= reach; ++x) {
      middle[-x] = middle[mirrored(-x, width)];
      middle[width - 1 + x] = middle[mirrored(width - 1 + x, width)];
    }
    for (std::size_t i = 0; i < count; ++i) {
      const int away = taps.apart * static_cast<int>(i);
      before[i] = middle - away;
      after[i] = middle + away;
    }
    float* out = to[y + 1];
    weigh_rows(before.data(), after.data(), taps.weight.data(), static_cast<int>(count), width, out + 1);
    out[0] = out[1];
    out[width + 1] = out[width];
  }
  to.row(1).copyTo(to.row(0));
  to.row(height).copyTo(to.row(height + 1));
  return to;
}

// Smooths the level before, which is cheaper than starting from the image and gives the same Gaussian.
void add_level(ScaleSpace& space, const cv::Mat1f& luma, double finest, int channel) {
  ScaleLevel level;
  level.octave = static_cast<int>(space.size());
  level.sigma = finest * std::pow(2.0, 0.5 * level.octave);
  level.channel = channel;
  level.frame = luma;
  const double before = space.empty() ? 0 : space.back().sigma;
  const Taps step = gaussian_taps(std::sqrt(level.sigma * level.sigma - before * before), before);
  level.smooth = space.empty() ? smoothed(luma, 0, step) : smoothed(space.back().smooth, 1, step);
  const cv::Mat1d whole = gaussian_kernel(level.sigma);
  const double plain = noise_gain(whole, {1});
  level.gradient_sd = std::sqrt(plain * noise_gain(whole, {0.5, 0, -0.5}));
  level.hessian_sd = std::sqrt(plain * noise_gain(whole, {1, -2, 1}));
  space.push_back(std::move(level));
}

}  // namespace

ScaleSpace scale_space(const cv::Mat1f& luma, double finest, int levels, int channel) {
  ScaleSpace space;
  for (int i = 0; i < levels; ++i) add_level(space, luma, finest, channel);
  return space;
}

ScaleSpace with_more_levels(ScaleSpace space, int more) {
  const ScaleLevel first = space.front();
  for (int i = 0; i < more; ++i) add_level(space, first.frame, first.sigma, first.channel);
  ScaleSpace all = scale_space(first.frame, first.sigma / std::numbers::sqrt2, 1, first.channel);
  for (ScaleLevel& level : space) {
    ++level.octave;
    all.push_back(std::move(level));
  }
  return all;
}

}  // namespace emberfold::sketch
