// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/heat_flow.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <sstream>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/inpainting/check_levels.hpp"

namespace emberfold::sketch {

namespace {

void check_start(const cv::Mat& levels, const cv::Mat& mask, double step) {
  check_levels_and_mask("HeatFlow", levels, mask);
  std::ostringstream message;
  if (!(step > 0 && step <= HeatFlow::kLargestStep))
    message << "HeatFlow: the step is " << step << " px²; it has to be above 0 and at most "
            << HeatFlow::kLargestStep;
  else if (!cv::checkRange(levels))
    message << "HeatFlow: the levels hold a number that is not finite";
  if (!message.str().empty()) throw core::InputError(message.str());
}

}  // namespace

HeatFlow::HeatFlow(const cv::Mat& levels, const cv::Mat& mask, double step)
    : width_(levels.cols), height_(levels.rows), channels_(levels.channels()), step_(step) {
  check_start(levels, mask, step);
  const auto stride = static_cast<std::size_t>(width_ + 2) * static_cast<std::size_t>(channels_);
  const auto row = static_cast<std::size_t>(width_) * static_cast<std::size_t>(channels_);
  now_.assign(stride * static_cast<std::size_t>(height_ + 2), 0.0F);
  next_ = now_;
  rate_.resize(row * static_cast<std::size_t>(height_));
  low_.assign(row, std::numeric_limits<float>::infinity());
  high_.assign(row, -std::numeric_limits<float>::infinity());
  const auto channels = static_cast<std::size_t>(channels_);
  for (int y = 0; y < height_; ++y) {
    const auto* values = levels.ptr<float>(y);
    const auto* held = mask.ptr(y);
    float* own = now_.data() + stride * static_cast<std::size_t>(y + 1) + channels;
    float* rate = rate_.data() + row * static_cast<std::size_t>(y);
    for (std::size_t i = 0; i < row; ++i) {
      own[i] = values[i];
      rate[i] = held[i / channels] != 0 ? 0.0F : static_cast<float>(step_);
      low_[i % channels] = std::min(low_[i % channels], values[i]);
      high_[i % channels] = std::max(high_[i % channels], values[i]);
    }
  }
  for (std::size_t i = channels; i < row; ++i) {
    low_[i] = low_[i % channels];
    high_[i] = high_[i % channels];
  }
}

void HeatFlow::step_rows() {
  const auto channels = static_cast<std::size_t>(channels_),
             row = static_cast<std::size_t>(width_) * channels;
  const std::size_t stride = row + 2 * channels;
  const auto at = [&](int y) { return now_.data() + stride * static_cast<std::size_t>(y + 1); };
  // The border repeats the outermost pixels, so nothing flows through it.
  for (int y = 0; y < height_; ++y) {
    std::copy_n(at(y) + channels, channels, at(y));
    std::copy_n(at(y) + row, channels, at(y) + row + channels);
  }
  std::copy_n(at(0), stride, at(-1));
  std::copy_n(at(height_ - 1), stride, at(height_));
  const float *low = low_.data(), *high = high_.data();
  for (int y = 0; y < height_; ++y) {
    const float* own = at(y) + channels;
    const float *west = own - channels, *east = own + channels, *north = own - stride, *south = own + stride;
    const float* rate = rate_.data() + row * static_cast<std::size_t>(y);
    float* __restrict to = next_.data() + stride * static_cast<std::size_t>(y + 1) + channels;
    for (std::size_t i = 0; i < row; ++i) {
      const float flow = (west[i] + east[i]) + (north[i] + south[i]) - 4 * own[i];
      const float value = own[i] + rate[i] * flow;
      // Rounding might carry it over the extremes.
      const float above = value < low[i] ? low[i] : value;
      to[i] = above > high[i] ? high[i] : above;
    }
  }
  now_.swap(next_);
}

void HeatFlow::advance(std::int64_t steps) {
  if (steps < 0) {
    std::ostringstream message;
    message << "HeatFlow: asked for " << steps << " steps; at least 0 are allowed";
    throw core::InputError(message.str());
  }
  for (std::int64_t i = 0; i < steps; ++i) step_rows();
  steps_ += steps;
}

cv::Mat HeatFlow::levels() const {
  cv::Mat result(height_, width_, CV_32FC(channels_));
  const auto channels = static_cast<std::size_t>(channels_),
             row = static_cast<std::size_t>(width_) * channels;
  for (int y = 0; y < height_; ++y)
    std::copy_n(now_.data() + (row + 2 * channels) * static_cast<std::size_t>(y + 1) + channels, row,
                result.ptr<float>(y));
  return result;
}

}  // namespace emberfold::sketch
