// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// The links between two frames, by vertex index.
struct FrameLinks {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;  ///< (index before, index after)
  std::vector<std::uint32_t> successors;                       ///< number of links of each vertex before
  std::vector<std::uint32_t> predecessors;                     ///< number of links of each vertex after
};
/// Looks up the vertices of links, all of which exist.
FrameLinks index_links(const AttributeGraph& before, const AttributeGraph& after,
                       std::span<const Link> links);

/// The partners of the vertices of two frames, by vertex index.
struct LinkPartners {
  std::vector<std::vector<std::uint32_t>> successors, predecessors;

  explicit LinkPartners(const FrameLinks& links);
  /// Returns whether a further link keeps the star forest: no link has others at both of its ends.
  [[nodiscard]] bool admit(std::size_t before, std::size_t after) const;
  void add(std::size_t before, std::size_t after);
};

/// A component before and one after that links connect.
struct ComponentPair {
  std::uint32_t before = 0, after = 0;
  std::uint32_t links = 0;
  Point first;  ///< lowest middle of a link by x, then y: an order that reversing time keeps
};
/// Finds all linked pairs of components, ordered by (before, after). O(links log links).
std::vector<ComponentPair> component_pairs(const AttributeGraph& before, const AttributeGraph& after,
                                           const Components& parts_before, const Components& parts_after,
                                           const FrameLinks& links);

/// Returns the mean displacement of a stroke from one frame to a neighbouring one, over its links, px; none
/// to the same frame. Summed in sorted order, so that reversing time gives the same bits.
Point mean_displacement(const MotionGraph& motion, SubgraphId stroke, std::size_t from, std::size_t to);

}  // namespace emberfold::graph::detail
