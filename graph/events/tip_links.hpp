// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// The components of two neighbouring frames, taken together where links connect them.
struct FrameClusters {
  std::vector<std::uint32_t> of_before, of_after;  ///< cluster of each vertex
  std::size_t count = 0;
};
/// Clusters two frames. O(n log n).
FrameClusters cluster_frames(const AttributeGraph& before, const AttributeGraph& after,
                             std::span<const Link> links);

/// Returns the vertices with one neighbour, ascending.
std::vector<std::uint32_t> tips_of(const AttributeGraph& graph);

/// Finds the tips of one frame in the next, as vertex indices: where its link leads or where it was, the
/// nearest within 20 px in the same cluster; one to one, at the least total distance. O(n log n + tips²) in
/// the tips of a cluster.
std::vector<std::pair<std::uint32_t, std::uint32_t>> link_tips(const AttributeGraph& before,
                                                               const AttributeGraph& after,
                                                               std::span<const Link> links,
                                                               const FrameClusters& clusters);

/// Returns the way from a tip back to the junction or tip at the other end of its curve, both included.
std::vector<std::uint32_t> way_from_tip(const AttributeGraph& graph, std::uint32_t tip);

}  // namespace emberfold::graph::detail
