// SPDX-License-Identifier: Apache-2.0
#include "apps/pictures/draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace emberfold::apps {

namespace {

constexpr int kShift = 4;  // OpenCV's fixed-point fraction bits: 1/16 px

cv::Scalar bgr(Colour c) {
  return {double(c.blue), double(c.green), double(c.red)};
}

/// Returns the number of edges of a patch that are seen.
std::size_t seen_edges(const graph::AttributeGraph& graph, std::size_t vertex) {
  const auto others = graph.neighbours(vertex);
  return static_cast<std::size_t>(std::ranges::count_if(
      others, [&](const auto other) { return is_seen(graph.patch(vertex), graph.patch(other)); }));
}

/// Returns the parts of curves that are seen.
std::vector<graph::Curve> seen_lines(const graph::AttributeGraph& graph) {
  std::vector<graph::Curve> lines;
  for (const graph::Curve& curve : graph::curves(graph)) {
    lines.emplace_back();
    for (const auto index : curve) {
      if (!lines.back().empty() && !is_seen(graph.patch(index), graph.patch(lines.back().back())))
        lines.emplace_back();
      lines.back().push_back(index);
    }
  }
  return lines;
}

cv::Point to_fixed_point(cv::Point2d p) {
  const double unit = 1 << kShift;
  return {static_cast<int>(std::lround(p.x * unit)), static_cast<int>(std::lround(p.y * unit))};
}

void draw_polyline(cv::Mat& picture, const std::vector<cv::Point2d>& points, const cv::Scalar& colour,
                   int thickness, bool closed = false) {
  std::vector<cv::Point> at;
  at.reserve(points.size());
  for (const auto& p : points) at.push_back(to_fixed_point(p));
  cv::polylines(picture, at, closed, colour, thickness, cv::LINE_AA, kShift);
}

void draw_disc(cv::Mat& picture, cv::Point2d centre, double radius, const cv::Scalar& colour, int thickness) {
  const int r = static_cast<int>(std::lround(radius * (1 << kShift)));
  cv::circle(picture, to_fixed_point(centre), r, colour, thickness, cv::LINE_AA, kShift);
}

void mark_outline(cv::Mat& picture, cv::Point2d c, graph::EventType type, double r, const cv::Scalar& colour,
                  int thickness) {
  const double h = r * std::sqrt(3.0) / 2, d = r * 0.8;
  using enum graph::EventType;
  switch (type) {
    case birth:
      draw_polyline(picture, {{c.x, c.y - r}, {c.x + h, c.y + r / 2}, {c.x - h, c.y + r / 2}}, colour,
                    thickness, true);
      break;
    case death:
      draw_polyline(picture, {{c.x, c.y + r}, {c.x + h, c.y - r / 2}, {c.x - h, c.y - r / 2}}, colour,
                    thickness, true);
      break;
    case split:
      draw_disc(picture, c, r * 0.9, colour, thickness);
      break;
    case merge:
      draw_polyline(picture, {{c.x - d, c.y - d}, {c.x + d, c.y - d}, {c.x + d, c.y + d}, {c.x - d, c.y + d}},
                    colour, thickness, true);
      break;
    case connect:
      draw_polyline(picture, {{c.x - r, c.y}, {c.x + r, c.y}}, colour, thickness);
      draw_polyline(picture, {{c.x, c.y - r}, {c.x, c.y + r}}, colour, thickness);
      break;
    case disconnect:
      draw_polyline(picture, {{c.x - d, c.y - d}, {c.x + d, c.y + d}}, colour, thickness);
      draw_polyline(picture, {{c.x - d, c.y + d}, {c.x + d, c.y - d}}, colour, thickness);
      break;
  }
}

}  // namespace

void write_text(cv::Mat& picture, const std::string& text, cv::Point at, double size, const cv::Scalar& ink) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, ink, 1, cv::LINE_AA);
}

int text_width(const std::string& text, double size) {
  int below = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &below).width;
}

std::string hex(Colour colour) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", colour.red, colour.green, colour.blue);
  return text.data();
}

Colour event_colour(graph::EventType type) {
  using enum graph::EventType;
  switch (type) {  // distinguishable with colour blindness
    case birth:
      return {0, 146, 104};
    case death:
      return {96, 96, 110};
    case split:
      return {0, 104, 190};
    case merge:
      return {214, 129, 0};
    case connect:
      return {150, 70, 170};
    case disconnect:
      return {200, 50, 50};
  }
  return {};
}

Colour stroke_colour(std::uint32_t identity) {
  const double turn = std::fmod(identity * 0.6180339887498949, 1.0);
  const double lift = identity % 2 == 0 ? 0.0 : 0.08;
  const auto channel = [&](double offset) {
    // lighter and softer than the pure hues, so that strokes are visible on a dark frame
    const double wave = 0.5 + 0.5 * std::cos(2 * std::numbers::pi * (turn - offset));
    return static_cast<unsigned char>(std::lround(255 * std::clamp(0.22 + lift + 0.78 * wave, 0.0, 1.0)));
  };
  return {channel(0), channel(1.0 / 3), channel(2.0 / 3)};
}

cv::Mat to_colour_bytes(const cv::Mat& frame, const core::ClipInfo& info) {
  return to_colour_bytes(core::to_levels(frame, info));
}

cv::Mat to_colour_bytes(const cv::Mat& levels) {
  cv::Mat bytes = core::to_bytes(levels), colour;
  if (bytes.channels() == 3) return bytes;
  cv::cvtColor(bytes, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

double enlargement(cv::Size frame, int shorter_side) {
  const double wanted = double(shorter_side) / std::min(frame.width, frame.height);
  const double room = 3840.0 / std::max(frame.width, frame.height);
  return std::max(1.0, std::min(wanted, room));
}

cv::Mat enlarge(const cv::Mat& frame, double scale) {
  const auto even = [&](int side) {
    return std::max(2, 2 * static_cast<int>(std::ceil(side * scale / 2 - 1e-9)));
  };
  const cv::Size size(even(frame.cols), even(frame.rows));
  cv::Mat large;
  if (scale == 1)  // an odd side repeats its last line instead of being resampled
    cv::copyMakeBorder(frame, large, 0, size.height - frame.rows, 0, size.width - frame.cols,
                       cv::BORDER_REPLICATE);
  else
    cv::resize(frame, large, size, 0, 0, cv::INTER_CUBIC);
  return large;
}

void draw_graph(cv::Mat& picture, const graph::AttributeGraph& graph, const Placement& place,
                const std::function<Colour(std::size_t)>& colour) {
  const cv::Scalar dark(24, 20, 20);
  const auto lines = seen_lines(graph);
  const auto draw_line = [&](const graph::Curve& line, const cv::Scalar& tint, int thickness) {
    std::vector<cv::Point2d> points;
    for (const auto index : line) points.push_back(place(graph.patch(index).position));
    if (points.size() > 1) draw_polyline(picture, points, tint, thickness);
  };
  for (const auto& line : lines) draw_line(line, dark, 4);
  for (const auto& line : lines) draw_line(line, bgr(colour(line.front())), 2);
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const auto& patch = graph.patch(i);
    if (graph::is_anchor(patch) || closes_at_border(patch)) continue;
    const cv::Point2d at = place(patch.position);
    const auto tint = bgr(colour(i));
    if (graph.degree(i) == 0) {
      draw_disc(picture, at, 3.5, dark, cv::FILLED);
      draw_disc(picture, at, 2.5, tint, cv::FILLED);
    } else if (seen_edges(graph, i) >= 3) {
      draw_disc(picture, at, 4.5, dark, cv::FILLED);
      draw_disc(picture, at, 3.5, {255, 255, 255}, cv::FILLED);
      draw_disc(picture, at, 2, tint, cv::FILLED);
    } else {
      const double reach = std::clamp(patch.width * place.scale / 2, 2.5, 4.5);
      const cv::Point2d across(-std::sin(patch.theta) * reach, std::cos(patch.theta) * reach);
      draw_polyline(picture, {at - across, at + across}, tint, 1);
    }
  }
}

void draw_mark(cv::Mat& picture, cv::Point2d centre, graph::EventType type, double radius, double opacity) {
  const int reach = static_cast<int>(std::ceil(radius)) + 6;
  const cv::Point corner(static_cast<int>(std::floor(centre.x)) - reach,
                         static_cast<int>(std::floor(centre.y)) - reach);
  const cv::Rect box =
      cv::Rect(corner, cv::Size(2 * reach + 1, 2 * reach + 1)) & cv::Rect({}, picture.size());
  if (box.empty()) return;
  cv::Mat under = picture(box), drawn = under.clone();
  const cv::Point2d at(centre.x - box.x, centre.y - box.y);
  mark_outline(drawn, at, type, radius, {255, 255, 255}, radius < 9 ? 4 : 5);
  mark_outline(drawn, at, type, radius, bgr(event_colour(type)), 2);
  cv::addWeighted(drawn, opacity, under, 1 - opacity, 0, under);
}

double mark_opacity(double probability) {
  return 0.3 + 0.7 * std::clamp(2 * probability - 1, 0.0, 1.0);
}

double mark_radius(std::size_t shown) {
  constexpr double kMost = 13, kLeast = 6, kRoom = 25;  // number of full-size marks that fit in a picture
  return std::clamp(kMost * std::sqrt(kRoom / std::max(1.0, double(shown))), kLeast, kMost);
}

std::vector<LegendItem> event_legend() {
  std::vector<LegendItem> items;
  for (const auto type : graph::all_event_types())
    items.push_back({std::string(graph::name(type)), event_colour(type), type});
  return items;
}

std::string frame_label(int frame) {
  const std::string digits = std::to_string(frame);
  return "frame " + std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits;
}

cv::Mat draw_legend(int width, const std::string& text, const std::vector<LegendItem>& items) {
  constexpr int kLine = 26, kMargin = 10, kSample = 22, kGap = 14;
  std::vector<cv::Point> places;  // x, line; of the text, then of each item
  cv::Point next(kMargin, 0);
  for (std::size_t i = 0; i <= items.size(); ++i) {
    const int needed = i == 0 ? text_width(text) : text_width(items[i - 1].label) + kSample;
    if (next.x + needed > width - kMargin && next.x > kMargin) next = {kMargin, next.y + 1};
    places.push_back(next);
    next.x += needed + kGap;
  }
  const int height = (next.y + 1) * kLine + 4;
  cv::Mat picture(height + height % 2, width, CV_8UC3, cv::Scalar(246, 248, 250));
  for (std::size_t i = 0; i <= items.size(); ++i) {
    const int middle = places[i].y * kLine + kLine / 2 + 2;
    int left = places[i].x;
    if (i > 0) {
      const auto& item = items[i - 1];
      const cv::Point2d at(left + 7.0, middle);
      if (item.mark)
        mark_outline(picture, at, *item.mark, 6, bgr(item.colour), 2);
      else
        draw_polyline(picture, {{at.x - 7, at.y}, {at.x + 7, at.y}}, bgr(item.colour), 3);
      left += kSample - 2;
    }
    write_text(picture, i == 0 ? text : items[i - 1].label, {left, middle + 4});
  }
  return picture;
}

}  // namespace emberfold::apps
