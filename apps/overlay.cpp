// SPDX-License-Identifier: Apache-2.0
#include "apps/overlay.hpp"

#include <algorithm>
#include <string>

#include <opencv2/core.hpp>

#include "apps/draw.hpp"

namespace emberfold::apps {

cv::Mat draw_sketch(const cv::Mat& frame, const graph::AttributeGraph& graph, const OverlayOptions& options) {
  const Placement place{enlargement(frame.size(), options.shorter_side), {}};
  cv::Mat picture = enlarge(frame, place.scale);
  picture.convertTo(picture, -1, options.brightness);
  draw_graph(picture, graph, place,
             [&](std::size_t index) { return stroke_colour(graph.vertices()[index].subgraph.value); });
  return picture;
}

std::span<const graph::Event> events_between(std::span<const graph::Event> events, int first, int last) {
  const auto begin = std::ranges::lower_bound(events, first, {}, &graph::Event::frame);
  const auto end = std::ranges::upper_bound(begin, events.end(), last, {}, &graph::Event::frame);
  return {begin, end};
}

cv::Mat draw_overlay(const cv::Mat& frame, const graph::AttributeGraph& graph, int frame_number,
                     std::span<const graph::Event> events, const OverlayOptions& options) {
  const Placement place{enlargement(frame.size(), options.shorter_side), {}};
  cv::Mat picture = draw_sketch(frame, graph, options);
  for (const auto& event : events_between(events, frame_number - options.flash_frames + 1, frame_number)) {
    const double age = double(frame_number - event.frame) / options.flash_frames;
    draw_mark(picture, place(event.position), event.type, 13 - 3 * age, 1 - 0.75 * age);
  }
  // the number is padded so that the legend breaks its lines at the same places in every frame
  const std::string digits = std::to_string(frame_number);
  const cv::Mat legend =
      draw_legend(picture.cols, "frame " + std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits);
  cv::Mat whole;
  cv::vconcat(picture, legend, whole);
  return whole;
}

}  // namespace emberfold::apps
