// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/clearer_channel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/clip/frame_stream.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kLeastTimes = 4;     // of the luma's contrast
constexpr double kLeastContrast = 1;  // grey levels; less is noise

/// Sums of squares of blue, green, red, as frames have them, and the luma.
using Squares = std::array<double, 4>;

/// Returns the mean square difference of neighbours.
Squares contrast_of(const cv::Mat& frame, const core::ClipInfo& info) {
  constexpr int kAcross = 64;
  const int across = std::min(kAcross, info.width), down = std::max(1, info.height * across / info.width);
  cv::Mat small;
  cv::resize(core::to_levels(frame, info), small, {across, down}, 0, 0, cv::INTER_AREA);
  std::array<cv::Mat1f, 4> channels;
  cv::split(small, channels.data());
  channels[3] = core::luma(small);
  Squares squares{};
  const cv::Rect all({0, 0}, small.size());
  for (std::size_t c = 0; c < channels.size(); ++c)
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
      const cv::Rect here = all & (all - step);
      if (here.empty()) continue;
      squares.at(c) +=
          cv::norm(channels.at(c)(here), channels.at(c)(here + step), cv::NORM_L2SQR) / here.area();
    }
  return squares;
}

}  // namespace

std::optional<ClearerChannel> find_clearer_channel(core::FrameSource& source, const core::Context& context) {
  const core::ClipInfo info = source.info();
  if (info.channels != 3) return {};
  Squares sum{};
  const int frames = core::stream_frames(
      source, "channels", info.frames, context,
      [&](int, const cv::Mat& frame) { return contrast_of(frame, info); },
      [&](int, const Squares& squares) {
        for (std::size_t c = 0; c < sum.size(); ++c) sum.at(c) += squares.at(c);
      });
  const auto greatest = std::max_element(sum.begin(), sum.begin() + 3);
  if (*greatest < kLeastContrast * kLeastContrast * frames ||
      *greatest < kLeastTimes * kLeastTimes * sum.back())
    return {};
  return ClearerChannel{2 - static_cast<int>(greatest - sum.begin()),
                        std::sqrt(*greatest / std::max(sum.back(), 1e-12))};
}

}  // namespace emberfold::pipeline
