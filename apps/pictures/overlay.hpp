// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/pictures/draw.hpp"
#include "graph/attribute_graph.hpp"
#include "graph/events/events.hpp"

namespace emberfold::apps {

struct OverlayOptions {
  int shorter_side = 480;    ///< px, ≥ 16: smaller frames are enlarged to this
  int flash_frames = 6;      ///< ≥ 1: how many frames an event's mark stays, fading
  double brightness = 0.78;  ///< of the frame under the drawing, (0, 1]
};

/// The frame (CV_8UC3) enlarged, with its graph: curves in their stroke's colour, patches as ticks, junctions
/// as rings.
cv::Mat draw_sketch(const cv::Mat& frame, const graph::AttributeGraph& graph,
                    const OverlayOptions& options = {});

/// One picture of the overlay video: draw_sketch, the marks of the events of `frame_number` and the frames
/// just before it, of probability 0.5 or more and the surer the stronger, and a legend below. `events` are
/// those of the whole clip, ordered by frame. Size depends on the frame's size alone.
cv::Mat draw_overlay(const cv::Mat& frame, const graph::AttributeGraph& graph, int frame_number,
                     std::span<const graph::Event> events, const OverlayOptions& options = {});

/// The same for a frame of which no strokes are known: curves in the colour of their type, explained below.
cv::Mat draw_types(const cv::Mat& frame, const graph::AttributeGraph& graph, int frame_number,
                   const OverlayOptions& options = {});

/// The picture and the legend's entries that this one is made of.
cv::Mat draw_type_curves(const cv::Mat& frame, const graph::AttributeGraph& graph,
                         const OverlayOptions& options = {});
std::vector<LegendItem> type_legend();

/// The events of frames first…last, of a list ordered by frame.
std::span<const graph::Event> events_between(std::span<const graph::Event> events, int first, int last);

}  // namespace emberfold::apps
