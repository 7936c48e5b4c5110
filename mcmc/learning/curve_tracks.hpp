// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::mcmc::detail {

/// A point of a curve in one frame.
struct Sample {
  graph::Point position;     ///< px, on the curve through the patches
  graph::Point normal;       ///< unit; its sense is kept from frame to frame
  double travel = 0;         ///< px, along the normals since the lineage began
  double contrast = 0;       ///< logarithm of its absolute value
  std::uint32_t vertex = 0;  ///< index of the nearest patch
};

/// A place on a curve followed through time. Patches are set down anew along a curve in every frame, so a
/// patch's own path jitters along it; a lineage instead goes from frame to frame along the curve's normal,
/// which is all of a curve's motion that an image shows.
struct Lineage {
  int first = 0;  ///< frame
  std::vector<Sample> samples;
  [[nodiscard]] int last() const { return first + static_cast<int>(samples.size()) - 1; }
};

/// Lineages through all places of curves that links carry on, about one for each patch inside a curve;
/// ordered by first frame, then vertex. O(vertices).
std::vector<Lineage> lineages(const graph::MotionGraph& motion);

/// For every frame the lineages that lie side by side on a curve there.
struct Neighbours {
  struct Pair {
    std::uint32_t a = 0, b = 0;  ///< lineage indices
    int sense = 1;               ///< −1 where their normals point to opposite sides
  };
  std::vector<std::vector<Pair>> frames;
};
Neighbours neighbours(const graph::MotionGraph& motion, const std::vector<Lineage>& lineages);

/// What lineages tell of patches: each patch gets the mean of what is told of it, smoothed along the curves;
/// a patch of which nothing is told takes its neighbours'.
struct Told {
  std::uint32_t vertex = 0;
  graph::Point value;
};
std::vector<graph::Point> on_patches(const graph::AttributeGraph& graph, const std::vector<Told>& told);

}  // namespace emberfold::mcmc::detail
