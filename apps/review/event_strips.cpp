// SPDX-License-Identifier: Apache-2.0
#include "apps/review/event_strips.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <opencv2/imgproc.hpp>

#include "apps/pictures/draw.hpp"
#include "core/clip/frame_stream.hpp"

namespace emberfold::apps {

namespace {

constexpr int kBefore = kStripFrames / 2;
const cv::Scalar kOutside(70, 66, 64);

/// Cuts out the square around a place, at the size of a cell.
cv::Mat cut_cell(const cv::Mat& frame, graph::Point place, int reach) {
  cv::Mat cell(2 * reach + 1, 2 * reach + 1, CV_8UC3, kOutside);
  const cv::Point corner(static_cast<int>(std::lround(std::clamp(place.x, -1e6, 1e6))) - reach,
                         static_cast<int>(std::lround(std::clamp(place.y, -1e6, 1e6))) - reach);
  const cv::Rect part = cv::Rect(corner, cell.size()) & cv::Rect({0, 0}, frame.size());
  if (!part.empty()) frame(part).copyTo(cell(part - corner));
  cv::Mat sized;
  cv::resize(cell, sized, {kStripCell, kStripCell}, 0, 0,
             cell.cols > kStripCell ? cv::INTER_AREA : cv::INTER_LINEAR);
  return sized;
}

}  // namespace

int strip_reach(const core::ClipInfo& info) {
  return std::clamp(std::max(info.width, info.height) / 8, 24, 96);
}

std::vector<Still> draw_event_strips(core::FrameSource& source, std::span<const graph::Event> events,
                                     std::size_t most_bytes, const Session& session) {
  std::multimap<int, std::size_t> by_frame;
  for (std::size_t k = 0; k < events.size(); ++k) by_frame.emplace(events[k].frame, k);
  std::vector<Still> strips(events.size());
  std::map<std::size_t, cv::Mat> open;
  const int reach = strip_reach(source.info());
  const auto finish_before = [&](int frame) {
    std::erase_if(open, [&](const auto& strip) {
      if (events[strip.first].frame + kBefore >= frame) return false;
      strips[strip.first] = make_still(strip.second, kStripFrames * kStripCell, most_bytes);
      return true;
    });
  };
  core::stream_frames(
      source, "review", source.info().frames, session.context,
      [&](int, const cv::Mat& frame) { return to_colour_bytes(frame, source.info()); },
      [&](int t, const cv::Mat& frame) {
        finish_before(t);
        const auto end = by_frame.upper_bound(t + kBefore);
        for (auto at = by_frame.lower_bound(t - kBefore); at != end; ++at) {
          auto& strip = open[at->second];
          if (strip.empty()) strip = cv::Mat(kStripCell, kStripFrames * kStripCell, CV_8UC3, kOutside);
          const int cell = t - at->first + kBefore;
          cut_cell(frame, events[at->second].position, reach)
              .copyTo(strip(cv::Rect(cell * kStripCell, 0, kStripCell, kStripCell)));
        }
      });
  for (const auto& [k, strip] : open) strips[k] = make_still(strip, kStripFrames * kStripCell, most_bytes);
  return strips;
}

}  // namespace emberfold::apps
