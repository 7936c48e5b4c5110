// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/patches/profile_shape.hpp"

// The places of patches in the frame: bands about the curves between them (render.hpp).
namespace emberfold::sketch {

// Chosen for the look of drawn strokes; no source.
inline constexpr double kLeastReach = 1.5;  ///< px to each side that a band shows at least
inline constexpr double kMostReach = 12;    ///< px to each side that a band shows at most
inline constexpr double kCore = 0.35;       ///< share of its reach that a band's core has
inline constexpr double kLeastMargin =
    1;  ///< px beyond the core: else a sharp line holds no pixel of its sides
inline constexpr double kBorderSlack = 1e-3;  ///< px: a pixel on the border of two bands is in both

/// Returns the distance to each side within which a patch's profile changes, px.
inline double profile_reach(const graph::Patch& patch) {
  const double margin = std::max(2 * std::max(patch.blur, kLeastBlur), kLeastMargin);
  return std::clamp(std::max(patch.width, 0.0) / 2 + margin, kLeastReach, kMostReach);
}

/// Returns a + s·(b − a).
inline double interpolate(double a, double b, double s) {
  return a + s * (b - a);
}

/// Holds which patch's profile a band shows at one end.
struct BandEnd {
  std::size_t vertex = 0;
  bool backwards = false;  ///< the patch's direction is against the band's
  double slope = 0;
  double reach = kLeastReach;
  bool round = false;  ///< rounded, to close the gap at a bend
};

/// Holds a band: a curve from `origin` over `length` px in direction `along`. To the right it rises by a
/// cubic with the slopes of its ends.
struct Band {
  graph::Point origin, along;
  double length = 0;
  BandEnd a, b;
  double before = 0, after = 0;  ///< px by which it goes on straight behind its ends
};

/// Returns one band for each edge, and one for each patch without edges that is no anchor, with its core
/// alone if `cores`. O(patches).
std::vector<Band> make_bands(const graph::AttributeGraph& graph, bool cores = false);

/// Holds the height of a band's curve above its chord, and its two derivatives.
struct Height {
  double value, slope, curvature;
};
inline Height height_at(const Band& band, double u) {
  const double c = std::clamp(u, 0.0, band.length), s = c / band.length;
  const double a = band.a.slope, b = band.b.slope;
  const double slope = a * (3 * s * s - 4 * s + 1) + b * (3 * s * s - 2 * s);
  const double value = band.length * s * (a * (s - 1) * (s - 1) + b * s * (s - 1)) + slope * (u - c);
  const bool inside = u == c;
  return {value, slope, inside ? (a * (6 * s - 4) + b * (6 * s - 2)) / band.length : 0};
}

/// Holds the nearest point of a band's curve to a pixel.
struct Projection {
  double s;           ///< place along the band, 0…1
  double distance;    ///< px from the curve, positive to the right
  bool at_round_end;  ///< the pixel lies beyond the end, in its rounding
};

/// Projects a pixel onto a band's curve; none where it lies beyond an end that is not round. (u0, v0): px
/// along and across the chord.
inline std::optional<Projection> project(const Band& band, double u0, double v0) {
  // Newton's method for the nearest point of the curve, from the one beneath.
  double u = u0;
  Height h = height_at(band, u);
  if (band.a.slope != 0 || band.b.slope != 0)
    for (int i = 0; i < 4; ++i) {
      const double gradient = (u - u0) + (h.value - v0) * h.slope;
      const double second = 1 + h.slope * h.slope + (h.value - v0) * h.curvature;
      const double step = gradient / std::max(second, 0.3);
      u -= step;
      h = height_at(band, u);
      if (std::abs(step) < 1e-4) break;
    }
  const double stretch = std::sqrt(1 + h.slope * h.slope);
  if (u >= -band.before - kBorderSlack && u <= band.length + band.after + kBorderSlack)
    return Projection{std::clamp(u / band.length, 0.0, 1.0), ((v0 - h.value) - (u0 - u) * h.slope) / stretch,
                      false};
  const bool at_a = u < band.length / 2;
  if (!(at_a ? band.a.round : band.b.round)) return std::nullopt;
  const double slope = at_a ? band.a.slope : band.b.slope, du = at_a ? u0 : u0 - band.length;
  return Projection{at_a ? 0.0 : 1.0, std::copysign(std::hypot(du, v0), v0 - slope * du), true};
}

/// Holds the whole numbers from `first` to `last`; the range can only shrink.
struct PixelRange {
  int first, last;
  /// Keeps the numbers x with low ≤ slope·x + offset ≤ high.
  void intersect(double slope, double offset, double low, double high) {
    if (std::abs(slope) < 1e-12) {
      if (offset < low || offset > high) last = first - 1;
      return;
    }
    double from = (low - offset) / slope, to = (high - offset) / slope;
    if (from > to) std::swap(from, to);
    const double begin = first, end = last;
    if (from > end || to < begin) {
      last = first - 1;
      return;
    }
    first = static_cast<int>(std::ceil(std::max(from, begin)));
    last = static_cast<int>(std::floor(std::min(to, end)));
  }
};

/// Calls paint(x, y, projection) for every pixel that the band covers.
template <class Paint>
void visit_band(const Band& band, cv::Size size, Paint paint) {
  const double reach = std::max(band.a.reach, band.b.reach);
  // The cubic stays below 4/27 of the length times the slopes; where it leans, so do its ends.
  const double side = reach + band.length * (std::abs(band.a.slope) + std::abs(band.b.slope)) * 4 / 27;
  const double lean_a = band.a.round ? 1 : std::min(std::abs(band.a.slope), 1.0);
  const double lean_b = band.b.round ? 1 : std::min(std::abs(band.b.slope), 1.0);
  const double low = -band.before - reach * lean_a - kBorderSlack;
  const double high = band.length + band.after + reach * lean_b + kBorderSlack;
  const graph::Point o = band.origin, t = band.along;
  const double tip = std::abs(t.x) * side;
  PixelRange rows{0, size.height - 1};
  rows.intersect(1, 0, o.y + std::min(low * t.y, high * t.y) - tip,
                 o.y + std::max(low * t.y, high * t.y) + tip);
  for (int y = rows.first; y <= rows.last; ++y) {
    // Along and across the chord, u = (p − o)·t and v = (p − o)·n with n = (−t.y, t.x).
    const double dy = y - o.y;
    PixelRange columns{0, size.width - 1};
    columns.intersect(t.x, dy * t.y - o.x * t.x, low, high);
    columns.intersect(-t.y, dy * t.x + o.x * t.y, -side, side);
    for (int x = columns.first; x <= columns.last; ++x) {
      const double dx = x - o.x;
      const auto at = project(band, dx * t.x + dy * t.y, dy * t.x - dx * t.y);
      if (at && std::abs(at->distance) <= interpolate(band.a.reach, band.b.reach, at->s)) paint(x, y, *at);
    }
  }
}

/// Returns a pixel's weight in a band: the greater the nearer to its middle. Rounded ends count where nothing
/// else does.
inline double band_weight(const Band& band, const Projection& at) {
  const double reach = interpolate(band.a.reach, band.b.reach, at.s);
  const double inward = std::max(1 - std::abs(at.distance) / reach, 0.03);
  return inward * inward * inward * inward * (at.at_round_end ? 1e-12 : 1);
}

/// Calls paint(vertex, x, y) for the pixel of every anchor in the frame.
template <class Paint>
void visit_anchors(const graph::AttributeGraph& graph, cv::Size size, Paint paint) {
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (!graph::is_anchor(graph.patch(i))) continue;
    const double x = std::round(graph.patch(i).position.x), y = std::round(graph.patch(i).position.y);
    if (x >= 0 && y >= 0 && x < size.width && y < size.height)
      paint(i, static_cast<int>(x), static_cast<int>(y));
  }
}

/// Checks a frame's format. Throws core::InputError for an empty size, or other than 1 or 3 channels.
void check_frame(cv::Size size, int channels);

}  // namespace emberfold::sketch
