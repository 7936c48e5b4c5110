// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

struct MatchOptions {
  double max_motion = 12;  ///< px a frame, > 0: nothing is linked farther than this from where it is expected
  double sigma_across = 2;  ///< px, > 0: spread of a patch about its expected place, across its curve
  double sigma_along =
      5;  ///< px, > 0: the same along the curve, where a patch can hardly be told from its neighbours
  double sigma_angle = 0.35;    ///< rad, > 0
  double sigma_contrast = 0.5;  ///< of the logarithm of the contrast, > 0
  double sigma_count = 0.5, sigma_shape = 3,
         sigma_degree = 1;  ///< c (log), s (px) and d of the coarse match, > 0
  int flicker = 3;          ///< frames, ≥ 0: states that last no longer are taken for noise
                            ///< (graph/matching/flicker_removal.hpp); 0: none

  void validate() const;
};

/// The links from one frame's graph to the next one's, sorted; a star forest. `velocity`: px a frame of each
/// vertex of `before` where its past is known, zero where not (empty: all zero).
std::vector<Link> match_frames(const AttributeGraph& before, const AttributeGraph& after,
                               std::span<const Point> velocity, const MatchOptions& options);

/// The links without those between components that too few of them hold together: in the smaller one at least
/// half of up to 3 vertices, else 6 links or a third of its vertices (at least 2). A stroke that dies beside
/// one that grows is not the same. `links` are sorted.
std::vector<Link> supported_links(const AttributeGraph& before, const AttributeGraph& after,
                                  std::vector<Link> links);

/// Links every frame to the next, bottom up (Wang & Zhu 2004, §3.2): subgraphs by count, shape, appearance
/// and degree, then control points in order along matched curves, then what is left by assignment. What then
/// flickers is steadied and matched anew. The start of the sampler. Cancelled: the frames matched so far.
MotionGraph match(SketchSequence sketch, const MatchOptions& options, const core::Context& context = {});

}  // namespace emberfold::graph
