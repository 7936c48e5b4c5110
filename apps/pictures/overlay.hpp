// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/draw.hpp"
#include "graph/attribute_graph.hpp"
#include "graph/events/events.hpp"

namespace emberfold::apps {

/// Holds the settings for drawing graphs on frames.
struct OverlayOptions {
  int shorter_side = 480;    ///< px, ≥ 16: smaller frames are enlarged to this
  int flash_frames = 6;      ///< ≥ 1: frames for which an event's mark is shown, fading
  double brightness = 0.78;  ///< of the frame under the drawing, (0, 1]
};

/// Draws a graph on its enlarged frame (CV_8UC3): curves in their stroke's colour, patches as ticks,
/// junctions as rings.
cv::Mat draw_sketch(const cv::Mat& frame, const graph::AttributeGraph& graph,
                    const OverlayOptions& options = {});

/// Draws one picture of the overlay video: the graph, marks of recent events and a legend. Marks are drawn
/// for events of probability 0.5 or more, more opaque with higher probability, and fade over flash_frames.
/// `events`: of the whole clip, ordered by frame. The size depends only on the frame's size.
cv::Mat draw_overlay(const cv::Mat& frame, const graph::AttributeGraph& graph, int frame_number,
                     std::span<const graph::Event> events, const OverlayOptions& options = {});

/// Draws a frame's graph without strokes, curves in the colour of their type, with a legend.
cv::Mat draw_types(const cv::Mat& frame, const graph::AttributeGraph& graph, int frame_number,
                   const OverlayOptions& options = {});

/// Draws the curves of draw_types() without a legend, and lists the legend's entries.
cv::Mat draw_type_curves(const cv::Mat& frame, const graph::AttributeGraph& graph,
                         const OverlayOptions& options = {});
std::vector<LegendItem> type_legend();

/// Returns the events of frames first…last from a list ordered by frame.
std::span<const graph::Event> events_between(std::span<const graph::Event> events, int first, int last);

}  // namespace emberfold::apps
