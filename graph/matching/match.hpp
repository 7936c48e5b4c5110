// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Options of match. Spreads are SDs of the Gaussians in a link's gain.
struct MatchOptions {
  double max_motion = 12;       ///< > 0: farthest that a patch may be from its expected position, px a frame
  double sigma_across = 2;      ///< > 0: of a patch about its expected position across its curve, px
  double sigma_along = 5;       ///< > 0: along its curve, where patches look alike, px
  double sigma_angle = 0.35;    ///< > 0: of the direction, rad
  double sigma_contrast = 0.5;  ///< > 0: of the logarithm of the contrast
  double sigma_count = 0.5;     ///< > 0: of c, the log number of control points, in the coarse match
  double sigma_shape = 3;       ///< > 0: of s, the shape, in the coarse match, px
  double sigma_degree = 1;      ///< > 0: of d, the degree, in the coarse match
  int flicker = 3;  ///< 0…100: longest change that remove_flicker takes for noise, frames; 0: none

  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// Links one frame's graph to the next one's.
/// Returns sorted links that form a star forest. `velocity`: expected motion of each vertex of `before`, px a
/// frame; empty: zero. Anchors get no links. Throws InputError for invalid options and for velocities of
/// another number or not finite.
std::vector<Link> match_frames(const AttributeGraph& before, const AttributeGraph& after,
                               std::span<const Point> velocity, const MatchOptions& options);

/// Drops the links between components that too few links connect; `links` are sorted, and none is an
/// anchor's. Kept are pairs with links for at least half of a smaller component of up to 3 vertices; of a
/// larger one 6 links, or 2 and a third of its vertices. So a dying stroke does not become a neighbour that
/// grows.
std::vector<Link> supported_links(const AttributeGraph& before, const AttributeGraph& after,
                                  std::vector<Link> links);

/// Links every frame to the next, bottom up (Wang & Zhu 2004, §3.2), and identifies the strokes.
/// Matched are first curves by count, shape, appearance and degree, then control points in order along
/// matched curves, then remaining points by assignment. Flicker is removed and the clip matched again. The
/// result is the start of the sampler; it is without the sketch's anchors. Throws InputError for invalid
/// options, Cancelled if `context` is stopped.
MotionGraph match(SketchSequence sketch, const MatchOptions& options, const core::Context& context = {});

}  // namespace emberfold::graph
