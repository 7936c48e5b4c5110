// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sketch/detection/creases.hpp"

namespace emberfold::sketch {

/// Holds a curve as a chain of subpixel points, about one a pixel.
struct Chain {
  CreaseKind kind = CreaseKind::ridge;
  std::vector<CreasePoint> points;  ///< theta directed along the chain
  bool closed = false;              ///< the last point goes on to the first
  std::array<int, 2> gap{0, 0};     ///< number of the gap at its first and last end, 0: none
};

/// Returns the sum of the evidence of a curve's points, nats.
double evidence(const Chain& chain);

/// Holds where curves begin.
struct TracingLimits {
  double seed;  ///< significance at which a curve begins; it goes on as far as the map has points
};

/// Links crease points into curves (Steger 1998). Begins at the most significant point and goes on to the
/// neighbour ahead that is nearest in place and direction. Every point belongs to one curve; points beside a
/// curve that run along with it are used up with it. O(points).
std::vector<Chain> trace_curves(const CreaseMap& map, const ScaleSpace& space, TracingLimits limits);

/// Returns the arc length from the first point to each point; px.
std::vector<double> arc_lengths(const Chain& chain);

/// Returns the unit direction of the chain at a point, from its neighbours `reach` points off.
graph::Point tangent(const Chain& chain, std::size_t at, std::size_t reach = 3);

/// Holds an end of a curve that is not closed.
struct CurveEnd {
  std::size_t chain = 0;
  bool back = false;               ///< the last point, else the first
  graph::Point position, outward;  ///< px; the unit direction in which the curve runs out
};

/// Returns the ends of all curves, two by two, in their order.
std::vector<CurveEnd> free_ends(const std::vector<Chain>& chains);

/// Returns the median of the best responding levels along a curve or a part of it. Only the channel counts
/// that most of its points belong to; at least one point.
std::size_t median_level(std::span<const CreasePoint> points, const ScaleSpace& space);

/// Removes the hooks at free ends, where a line's round end makes the crease turn aside.
std::vector<Chain> remove_hooks(std::vector<Chain> chains);

}  // namespace emberfold::sketch
