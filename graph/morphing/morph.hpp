// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/context.hpp"
#include "core/option_field.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Options of morph.
struct MorphOptions {
  int frames = 30;

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::between;
    return std::to_array<core::OptionField<MorphOptions>>({
        {"frames", &MorphOptions::frames, "N", between(3, 10000),
         "Draw this many frames of a morph, both ends included"},
    });
  }
  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// Holds a shortest path from one graph to another, frame by frame.
struct Morph {
  /// Frame 0 is the first graph, the last frame the second one, both without anchors; linked and identified.
  MotionGraph motion;
  std::vector<std::vector<float>> opacity;  ///< of the patches of each frame, by index, 0…1
  double length = 0;                        ///< px, the distance between the graphs
  std::size_t moved = 0;                    ///< pairs of curves, one of each graph
  std::size_t died = 0, born = 0;           ///< curves of the first graph, and of the second, without partner
};

/// Finds the shortest path between two graphs and walks it at an even speed (docs/method/morphing.md).
/// Curves of both graphs are paired, each with at most one, so that the whole path is shortest. A pair's
/// middle, length, directions and looks change evenly; where arms meet in both graphs at one junction, they
/// stay joined. Curves without partner fade out in the first half, or in in the second. The length is the
/// root mean square, over the curves' length, of how far their points go; fading counts as 200 px. It is
/// 0 for equal graphs and the same in both directions; the reversed path is the path between the exchanged
/// graphs. `width`, `height`, `fps`: of the result. Throws InputError for invalid options, for a size or rate
/// that is not positive, and for more than 4000 curves in a graph; Cancelled. O(curves² patches + curves³).
/// Source: the extension to morphing proposed by Wang & Zhu 2004, §4; bending of curves as in Mio, Srivastava
/// & Joshi 2007.
Morph morph(const AttributeGraph& from, const AttributeGraph& to, int width, int height, double fps,
            const MorphOptions& options, const core::Context& context = {});

}  // namespace emberfold::graph
