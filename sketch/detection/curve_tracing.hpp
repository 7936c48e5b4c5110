// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sketch/detection/creases.hpp"

namespace emberfold::sketch {

/// A curve as a chain of subpixel points, about one a pixel.
struct Chain {
  CreaseKind kind = CreaseKind::ridge;
  std::vector<CreasePoint> points;  ///< theta directed along the chain
  bool closed = false;              ///< the last point goes on to the first
  std::array<int, 2> gap{0, 0};     ///< of its first and last end: the gap they lie at, 0: none
};

struct TracingLimits {
  double seed;  ///< significance at which a curve begins; it goes on as far as the map has points
};

/// Links crease points into curves (Steger 1998): from the most significant point on, to the neighbour ahead
/// that is nearest in place and direction. Every point goes to one curve; points beside a curve that run
/// along with it are spent with it.
std::vector<Chain> trace_curves(const CreaseMap& map, const ScaleSpace& space, TracingLimits limits);

/// Arc length from the first point to each point; px.
std::vector<double> arc_lengths(const Chain& chain);

/// Unit direction in which the chain runs at this point, from its neighbours `reach` points off.
graph::Point tangent(const Chain& chain, std::size_t at, std::size_t reach = 3);

/// The scale in the middle of those that responded best, along a curve or a part of it, of the channel that
/// most of its points belong to; at least one point.
std::size_t median_level(std::span<const CreasePoint> points, const ScaleSpace& space);

/// Takes off the hooks at free ends, where a line's round end makes the crease turn aside.
std::vector<Chain> remove_hooks(std::vector<Chain> chains);

}  // namespace emberfold::sketch
