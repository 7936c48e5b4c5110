// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/fill.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "sketch/inpainting/check_levels.hpp"
#include "sketch/inpainting/diffusion.hpp"

namespace emberfold::sketch {

namespace {

/// Range of the held pixels of one channel.
struct Values {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  [[nodiscard]] double middle() const { return (low + high) / 2; }
};

Values held_values(const cv::Mat& levels, const std::vector<const std::uint8_t*>& held, int channel) {
  const int channels = levels.channels();
  Values values;
  for (int y = 0; y < levels.rows; ++y) {
    const float* row = levels.ptr<float>(y) + channel;
    const std::uint8_t* mask = held[static_cast<std::size_t>(y)];
    float low = std::numeric_limits<float>::infinity(), high = -low;
    bool finite = true;
    for (int x = 0; x < levels.cols; ++x) {
      const bool counts = mask[x] != 0;
      const float value = row[x * channels];
      finite &= !counts || std::abs(value) <= std::numeric_limits<float>::max();
      low = counts && value < low ? value : low;
      high = counts && value > high ? value : high;
    }
    if (!finite) {
      std::ostringstream message;
      message << "fill: row " << y
              << " of the levels holds a number that is not finite where the mask is set";
      throw core::InputError(message.str());
    }
    values.low = std::min(values.low, static_cast<double>(low));
    values.high = std::max(values.high, static_cast<double>(high));
  }
  return values;
}

void check_held(const cv::Mat& levels, const cv::Mat& mask) {
  std::vector<const std::uint8_t*> held;
  for (int y = 0; y < mask.rows; ++y) held.push_back(mask.ptr(y));
  for (int channel = 0; channel < levels.channels(); ++channel) held_values(levels, held, channel);
}

template <class Real>
class Filler {
 public:
  Filler(const cv::Mat& levels, const std::vector<const std::uint8_t*>& held, double sink)
      : levels_(levels), held_(held), diffusion_(levels.cols, levels.rows, held, static_cast<Real>(sink)) {}

  /// Fills one channel of `result`, a copy of the levels. Works on deviations from the middle in units of
  /// the range, so that rounding does not depend on either.
  void fill(int channel, const Values& values, const FillOptions& options, FillResult& result) {
    const int channels = levels_.channels(), width = levels_.cols;
    const double middle = values.middle(), range = values.high - values.low;
    auto field = make_board<Real>(width, levels_.rows);
    auto& cells = diffusion_.row();
    std::fill(cells.begin(), cells.end(), Real(0));
    for (int y = 0; y < levels_.rows; ++y) {
      const float* row = levels_.ptr<float>(y) + channel;
      const std::uint8_t* held = held_[static_cast<std::size_t>(y)];
      for (int x = 0; x < width; ++x) {
        const auto value = static_cast<Real>((static_cast<double>(row[x * channels]) - middle) / range);
        cells[static_cast<std::size_t>(x)] = held[x] != 0 ? value : Real(0);
      }
      split_row(cells.data(), y, field);
    }
    const auto outcome = diffusion_.solve(field, options.tolerance / range, options.max_iterations);
    for (int y = 0; y < levels_.rows; ++y) {
      join_row(field, y, cells.data());
      float* row = result.levels.ptr<float>(y) + channel;
      const std::uint8_t* held = held_[static_cast<std::size_t>(y)];
      for (int x = 0; x < width; ++x) {
        // Between the extremes of what is held, as the exact solution is.
        const double value =
            std::clamp(middle + range * static_cast<double>(cells[static_cast<std::size_t>(x)]), values.low,
                       values.high);
        row[x * channels] = held[x] != 0 ? row[x * channels] : static_cast<float>(value);
      }
    }
    result.iterations = std::max(result.iterations, outcome.iterations);
    result.error = std::max(result.error, outcome.error * range);
    result.converged = result.converged && outcome.converged;
  }

 private:
  const cv::Mat& levels_;
  const std::vector<const std::uint8_t*>& held_;
  Diffusion<Real> diffusion_;
};

template <class Real>
void fill_channels(const cv::Mat& levels, const std::vector<const std::uint8_t*>& held,
                   const std::vector<Values>& values, double sink, const FillOptions& options,
                   FillResult& result) {
  Filler<Real> filler(levels, held, sink);
  for (int channel = 0; channel < levels.channels(); ++channel) {
    const Values& of_channel = values[static_cast<std::size_t>(channel)];
    if (of_channel.high > of_channel.low) filler.fill(channel, of_channel, options, result);
  }
}

/// True if single precision would miss the tolerance. In a long strip heat comes from far away through a few
/// pixels, which multiplies rounding errors by the square of the length.
bool needs_double(const cv::Size size, double range, double tolerance) {
  return std::max(size.width, size.height) > 32 * std::min(size.width, size.height) ||
         tolerance < 3e-5 * range;
}

/// Solves for the pixels that are not held, of which there are some and not all. With a sink they are drawn
/// to 0, and the range of each channel lies about that.
FillResult diffuse(const cv::Mat& levels, const cv::Mat& mask, double sink, const FillOptions& options) {
  std::vector<const std::uint8_t*> held;
  for (int y = 0; y < mask.rows; ++y) held.push_back(mask.ptr(y));
  std::vector<Values> values;
  double range = 0;
  cv::Scalar middle;
  for (int channel = 0; channel < levels.channels(); ++channel) {
    Values of_channel = held_values(levels, held, channel);
    if (sink > 0) {
      of_channel.high = std::max(std::abs(of_channel.low), std::abs(of_channel.high));
      of_channel.low = -of_channel.high;
    }
    values.push_back(of_channel);
    range = std::max(range, of_channel.high - of_channel.low);
    middle[channel] = of_channel.middle();
  }
  FillResult result;
  result.levels = levels.clone();
  // Without a range there is nothing to solve: all pixels have the held level.
  result.levels.setTo(middle, mask == 0);
  if (needs_double(levels.size(), range, options.tolerance))
    fill_channels<double>(levels, held, values, sink, options, result);
  else
    fill_channels<float>(levels, held, values, sink, options, result);
  return result;
}

void check_background(const cv::Mat& levels, const cv::Mat& background, double reach) {
  std::ostringstream message;
  if (background.dims != 2 || background.type() != levels.type() || background.size() != levels.size())
    message << "fill_onto: the ground is " << cv::typeToString(background.type()) << ", " << background.cols
            << " × " << background.rows << "; it has to be of the levels' type and size, "
            << cv::typeToString(levels.type()) << ", " << levels.cols << " × " << levels.rows;
  else if (!(reach >= 1 && reach <= 1e4))
    message << "fill_onto: reach is " << reach << "; allowed are 1 to 10000 px";
  else if (!cv::checkRange(background))
    message << "fill_onto: the ground holds a number that is not finite";
  if (!message.str().empty()) throw core::InputError(message.str());
}

}  // namespace

void FillOptions::validate() const {
  core::check_above("FillOptions.tolerance", tolerance, 0);
  core::check_at_least("FillOptions.max_iterations", max_iterations, 1);
}

FillResult fill(const cv::Mat& levels, const cv::Mat& mask, const FillOptions& options) {
  options.validate();
  check_levels_and_mask("fill", levels, mask);
  const int count = cv::countNonZero(mask);
  if (count == 0) return {cv::Mat(levels.size(), levels.type(), cv::Scalar::all(0))};
  if (count == mask.rows * mask.cols) {
    check_held(levels, mask);
    return {levels.clone()};
  }
  return diffuse(levels, mask, 0, options);
}

FillResult fill_onto(const cv::Mat& levels, const cv::Mat& mask, const cv::Mat& background, double reach) {
  check_levels_and_mask("fill", levels, mask);
  check_background(levels, background, reach);
  const int count = cv::countNonZero(mask);
  if (count == 0) return {background.clone()};
  if (count == mask.rows * mask.cols) {
    check_held(levels, mask);
    return {levels.clone()};
  }
  FillResult result = diffuse(levels - background, mask, 1 / (reach * reach), {});
  result.levels += background;
  levels.copyTo(result.levels, mask);
  return result;
}

}  // namespace emberfold::sketch
