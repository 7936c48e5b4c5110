// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/first_look.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "core/clip/frame_stream.hpp"
#include "core/math/robust.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kAcross = 64;         // cells of a reduced frame
constexpr double kLeastLike = 0.5;  // of the clip's median
constexpr double kChanged = 6,
                 kMostCells = 0.5;    // grey levels, as figures' least contrast; share of the frame
constexpr double kFlat = 1e-3;        // grey levels², of a frame without a picture
constexpr double kLeastTimes = 4;     // of the luma's contrast; 36 real and made clips have 1 to 1.15
constexpr double kLeastContrast = 1;  // grey levels; less is noise

using Squares = std::array<double, 4>;  // of blue, green, red, as frames have them, and of the luma

/// A reduced frame.
struct Reduced {
  cv::Mat1f luma;
  Squares contrast{};  // mean squares of differences of neighbours
};

double contrast_of(const cv::Mat1f& level) {
  const cv::Rect all({0, 0}, level.size());
  double squares = 0;
  for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
    const cv::Rect here = all & (all - step);
    if (!here.empty()) squares += cv::norm(level(here), level(here + step), cv::NORM_L2SQR) / here.area();
  }
  return squares;
}

Reduced reduced(const cv::Mat& frame, const core::ClipInfo& info) {
  const int across = std::min(kAcross, info.width);
  cv::Mat small;
  cv::resize(core::to_levels(frame, info), small, {across, std::max(1, info.height * across / info.width)}, 0,
             0, cv::INTER_AREA);
  Reduced out{core::luma(small), {}};
  if (small.channels() != 3) return out;
  std::array<cv::Mat1f, 3> channels;
  cv::split(small, channels.data());
  for (std::size_t c = 0; c < channels.size(); ++c) out.contrast.at(c) = contrast_of(channels.at(c));
  out.contrast.back() = contrast_of(out.luma);
  return out;
}

/// Returns the correlation of the levels of two frames: 1 for two frames without a picture, 0 if one has
/// none.
double likeness(const cv::Mat1f& a, const cv::Mat1f& b) {
  const cv::Mat one = a - cv::mean(a)[0], other = b - cv::mean(b)[0];
  const double first = one.dot(one), second = other.dot(other), flat = kFlat * double(a.total());
  if (first < flat || second < flat) return first < flat && second < flat ? 1 : 0;
  return one.dot(other) / std::sqrt(first * second);
}

double changed_share(const cv::Mat1f& a, const cv::Mat1f& b) {
  return cv::countNonZero(cv::abs(a - b) >= kChanged) / double(a.total());
}

/// Returns the clearer channel of a number of frames, given the sums of their contrasts.
std::optional<ClearerChannel> clearer_channel(const Squares& contrast, int frames) {
  const auto* const greatest = std::max_element(contrast.begin(), contrast.begin() + 3);
  const double luma = contrast.back();
  if (*greatest < kLeastContrast * kLeastContrast * frames || *greatest < kLeastTimes * kLeastTimes * luma)
    return {};
  return ClearerChannel{2 - static_cast<int>(greatest - contrast.begin()),
                        std::sqrt(*greatest / std::max(luma, 1e-12))};
}

}  // namespace

FirstLook look_over(core::FrameSource& source, const core::Context& context) {
  const core::ClipInfo info = source.info();
  cv::Mat1f before;
  std::vector<double> like, changed;  // by gap
  Squares contrast{};
  const int frames = core::stream_frames(
      source, "look", info.frames, context, [&](int, const cv::Mat& frame) { return reduced(frame, info); },
      [&](int, const Reduced& frame) {
        if (!before.empty())
          like.push_back(likeness(before, frame.luma)), changed.push_back(changed_share(before, frame.luma));
        before = frame.luma;
        for (std::size_t c = 0; c < contrast.size(); ++c) contrast.at(c) += frame.contrast.at(c);
      });
  FirstLook look{{}, clearer_channel(contrast, frames)};
  if (like.empty()) return look;
  const double usual = core::median(like);
  for (std::size_t gap = 0; gap < like.size(); ++gap)
    if (like[gap] < kLeastLike * usual && changed[gap] >= kMostCells)
      look.cuts.push_back(static_cast<int>(gap) + 1);
  return look;
}

void disbelieve_cuts(std::vector<graph::Event>& events, const std::vector<int>& cuts) {
  for (graph::Event& event : events)
    if (std::ranges::any_of(cuts, [&](int cut) { return std::abs(event.frame - cut) <= 1; }))
      event.probability = 0;
}

}  // namespace emberfold::pipeline
