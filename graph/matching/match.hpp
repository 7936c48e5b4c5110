// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "core/option_field.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Options of match.
struct MatchOptions {
  double max_motion = 12;
  int flicker = 3;

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::above, core::between;
    return std::to_array<core::OptionField<MatchOptions>>({
        {"max_motion", &MatchOptions::max_motion, "PX", above(0),
         "Link nothing farther than this from its expected place"},
        {"flicker", &MatchOptions::flicker, "FRAMES", between(0, 100),
         "Undo changes that reverse each other within this number of frames; 0: none"},
    });
  }
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
/// matched curves, then remaining points by assignment. This is done in the order of time and against it;
/// where the two differ, the simpler one counts, so that a clip played backwards has the same graph
/// backwards. Flicker is removed and the clip matched again. The result is without the sketch's
/// anchors. Throws InputError for invalid options, Cancelled if `context` is stopped.
MotionGraph match(SketchSequence sketch, const MatchOptions& options, const core::Context& context = {});

}  // namespace emberfold::graph
