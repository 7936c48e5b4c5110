// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/cuts.hpp"

#include <algorithm>
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
                 kMostCells = 0.5;  // grey levels, as figures' least contrast; share of the frame
constexpr double kFlat = 1e-3;      // grey levels², of a frame without a picture

cv::Mat1f reduced(const cv::Mat& frame, const core::ClipInfo& info) {
  const int across = std::min(kAcross, info.width);
  cv::Mat out;
  cv::resize(core::luma(frame, info), out, {across, std::max(1, info.height * across / info.width)}, 0, 0,
             cv::INTER_AREA);
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

}  // namespace

std::vector<int> find_cuts(core::FrameSource& source, const core::Context& context) {
  const core::ClipInfo info = source.info();
  cv::Mat1f before;
  std::vector<double> like, changed;  // by gap
  core::stream_frames(
      source, "cuts", info.frames, context, [&](int, const cv::Mat& frame) { return reduced(frame, info); },
      [&](int, const cv::Mat1f& frame) {
        if (!before.empty())
          like.push_back(likeness(before, frame)), changed.push_back(changed_share(before, frame));
        before = frame;
      });
  std::vector<int> cuts;
  if (like.empty()) return cuts;
  const double usual = core::median(like);
  for (std::size_t gap = 0; gap < like.size(); ++gap)
    if (like[gap] < kLeastLike * usual && changed[gap] >= kMostCells)
      cuts.push_back(static_cast<int>(gap) + 1);
  return cuts;
}

void disbelieve_cuts(std::vector<graph::Event>& events, const std::vector<int>& cuts) {
  for (graph::Event& event : events)
    if (std::ranges::any_of(cuts, [&](int cut) { return std::abs(event.frame - cut) <= 1; }))
      event.probability = 0;
}

}  // namespace emberfold::pipeline
