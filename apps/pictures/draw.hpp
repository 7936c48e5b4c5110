// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "graph/attribute_graph.hpp"
#include "graph/events/events.hpp"

namespace emberfold::apps {

struct Colour {
  unsigned char red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};
/// #rrggbb
std::string hex(Colour colour);

/// What an event is drawn in, in videos, pictures and the report alike.
Colour event_colour(graph::EventType type);

/// A colour of its own for every identity, the same in every picture; neighbouring identities differ most.
Colour stroke_colour(std::uint32_t identity);

/// The frame as CV_8UC3.
cv::Mat to_colour_bytes(const cv::Mat& frame, const core::ClipInfo& info);

/// How often the frame is enlarged so that its shorter side is at least `shorter_side` px, while the longer
/// one stays within 3840 px; ≥ 1.
double enlargement(cv::Size frame, int shorter_side);

/// The frame (CV_8UC3) enlarged; width and height are even, as video wants them.
cv::Mat enlarge(const cv::Mat& frame, double scale);

/// Clip pixels to picture pixels of a frame enlarged by `scale` at `origin`; pixel centres are integers in
/// both.
struct Placement {
  double scale = 1;
  cv::Point2d origin{0, 0};
  [[nodiscard]] cv::Point2d operator()(graph::Point p) const {
    return {origin.x + (p.x + 0.5) * scale - 0.5, origin.y + (p.y + 0.5) * scale - 0.5};
  }
};

/// Curves in the colour of their stroke, a tick across every patch, a dot where a patch stands alone, a ring
/// at junctions. `colour` is asked by vertex index.
void draw_graph(cv::Mat& picture, const graph::AttributeGraph& graph, const Placement& place,
                const std::function<Colour(std::size_t)>& colour);

/// The mark of an event, as Wang & Zhu 2004 have them: □ merge, ○ split, ▽ death, △ birth; + connect and
/// × disconnect.
void draw_mark(cv::Mat& picture, cv::Point2d centre, graph::EventType type, double radius,
               double opacity = 1);

/// Of the mark of an event, by its probability: 1 where that is 1, 0.3 at one half.
double mark_opacity(double probability);

/// The radius of marks, px, where so many of them are shown at once: the more, the smaller.
double mark_radius(std::size_t shown);

/// One entry of a legend: an event's mark, or a stroke of its colour.
struct LegendItem {
  std::string label;
  Colour colour;
  std::optional<graph::EventType> mark = {};
};
/// The six marks.
std::vector<LegendItem> event_legend();
/// A light strip of the given width, as many lines as it needs, `text` first. An even number of lines high.
cv::Mat draw_legend(int width, const std::string& text, const std::vector<LegendItem>& items);

/// "frame 00031": the same width for every frame, so that a legend breaks its lines at the same places.
std::string frame_label(int frame);

}  // namespace emberfold::apps
