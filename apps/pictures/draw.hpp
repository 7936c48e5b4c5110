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

/// A colour of 8 bits per channel.
struct Colour {
  unsigned char red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};
/// Colours of text and background in drawn tables and plots, BGR.
inline const cv::Scalar kInk(60, 52, 48), kPaper(250, 248, 246);

/// The usual size of text, as a factor of OpenCV's Hershey font.
constexpr double kTextSize = 0.42;

/// Writes ASCII text whose baseline begins at `at`.
void write_text(cv::Mat& picture, const std::string& text, cv::Point at, double size = kTextSize,
                const cv::Scalar& ink = kInk);

/// Returns the width of ASCII text, px.
int text_width(const std::string& text, double size = kTextSize);

/// Writes a colour as "#rrggbb".
std::string hex(Colour colour);

/// Returns the colour of an event type in videos, pictures and the report.
Colour event_colour(graph::EventType type);

/// Returns an identity's colour, the same in every picture; neighbouring identities differ most.
Colour stroke_colour(std::uint32_t identity);

/// Converts a frame to CV_8UC3.
cv::Mat to_colour_bytes(const cv::Mat& frame, const core::ClipInfo& info);
/// Converts levels (CV_32F, white = 255) to CV_8UC3.
cv::Mat to_colour_bytes(const cv::Mat& levels);

/// Returns the factor (≥ 1) that brings the shorter side to `shorter_side` px and keeps the longer within
/// 3840 px.
double enlargement(cv::Size frame, int shorter_side);

/// Enlarges a frame (CV_8UC3) to even width and height, as video needs.
cv::Mat enlarge(const cv::Mat& frame, double scale);

/// Maps clip pixels to pixels of a picture enlarged by `scale` at `origin`; pixel centres are integers in
/// both.
struct Placement {
  double scale = 1;
  cv::Point2d origin{0, 0};
  [[nodiscard]] cv::Point2d operator()(graph::Point p) const {
    return {origin.x + (p.x + 0.5) * scale - 0.5, origin.y + (p.y + 0.5) * scale - 0.5};
  }
};

/// Draws curves in the colour of their stroke, a tick across every patch, a dot for a single patch, a ring at
/// junctions; anchors and outlines along the picture's border are left out. `colour` takes the vertex index.
void draw_graph(cv::Mat& picture, const graph::AttributeGraph& graph, const Placement& place,
                const std::function<Colour(std::size_t)>& colour);

/// Draws the mark of an event: □ merge, ○ split, ▽ death, △ birth (Wang & Zhu 2004), + connect, × disconnect.
void draw_mark(cv::Mat& picture, cv::Point2d centre, graph::EventType type, double radius,
               double opacity = 1);

/// Returns the opacity of an event's mark: 1 at probability 1, 0.3 at one half.
double mark_opacity(double probability);

/// Returns the radius of marks, px; it decreases with the number shown at once.
double mark_radius(std::size_t shown);

/// One entry of a legend: an event's mark, or a stroke in its colour.
struct LegendItem {
  std::string label;
  Colour colour;
  std::optional<graph::EventType> mark = {};
};
/// Lists the six marks.
std::vector<LegendItem> event_legend();
/// Draws a light strip of the given width with `text` and items; its height is even, in pixels.
cv::Mat draw_legend(int width, const std::string& text, const std::vector<LegendItem>& items);

/// Returns "frame 00031", of constant width, so that a legend breaks its lines at the same places in all
/// frames.
std::string frame_label(int frame);

}  // namespace emberfold::apps
