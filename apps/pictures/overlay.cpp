// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/overlay.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

namespace emberfold::apps {

namespace {

enum class Look { bright_line, dark_line, step };

Look look(const graph::Patch& patch) {
  if (graph::on_step(patch)) return Look::step;
  return patch.contrast < 0 ? Look::dark_line : Look::bright_line;
}

Colour look_colour(Look look) {
  if (look == Look::step) return {110, 225, 130};
  return look == Look::dark_line ? Colour{95, 175, 255} : Colour{255, 165, 60};
}

}  // namespace

cv::Mat draw_sketch(const cv::Mat& frame, const graph::AttributeGraph& graph, const OverlayOptions& options) {
  const Placement place{enlargement(frame.size(), options.shorter_side), {}};
  cv::Mat picture = enlarge(frame, place.scale);
  picture.convertTo(picture, -1, options.brightness);
  draw_graph(picture, graph, place,
             [&](std::size_t index) { return stroke_colour(graph.vertices()[index].subgraph.value); });
  return picture;
}

cv::Mat draw_type_curves(const cv::Mat& frame, const graph::AttributeGraph& graph,
                         const OverlayOptions& options) {
  const Placement place{enlargement(frame.size(), options.shorter_side), {}};
  cv::Mat picture = enlarge(frame, place.scale);
  picture.convertTo(picture, -1, options.brightness);
  draw_graph(picture, graph, place, [&](std::size_t index) { return look_colour(look(graph.patch(index))); });
  return picture;
}

std::vector<LegendItem> type_legend() {
  return {{"bright line", look_colour(Look::bright_line)},
          {"dark line", look_colour(Look::dark_line)},
          {"step", look_colour(Look::step)}};
}

cv::Mat draw_types(const cv::Mat& frame, const graph::AttributeGraph& graph, int frame_number,
                   const OverlayOptions& options) {
  const cv::Mat picture = draw_type_curves(frame, graph, options);
  const cv::Mat legend = draw_legend(picture.cols, frame_label(frame_number), type_legend());
  cv::Mat whole;
  cv::vconcat(picture, legend, whole);
  return whole;
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
  const auto shown = events_between(events, frame_number - options.flash_frames + 1, frame_number);
  const double radius = mark_radius(shown.size());
  for (const auto& event : shown) {
    if (event.probability < 0.5) continue;
    const double age = double(frame_number - event.frame) / options.flash_frames;
    draw_mark(picture, place(event.position), event.type, radius * (1 - 0.2 * age),
              (1 - age) * (1 - age * 0.5) * mark_opacity(event.probability));
  }
  const cv::Mat legend = draw_legend(picture.cols, frame_label(frame_number), event_legend());
  cv::Mat whole;
  cv::vconcat(picture, legend, whole);
  return whole;
}

}  // namespace emberfold::apps
