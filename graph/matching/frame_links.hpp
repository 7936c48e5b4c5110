// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// The links between two frames, by vertex index.
struct Gap {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;  ///< (index before, index after)
  std::vector<std::uint32_t> successors;                       ///< how many each vertex before has
  std::vector<std::uint32_t> predecessors;                     ///< how many each vertex after has
};
/// The links join vertices that are there.
Gap gap(const AttributeGraph& before, const AttributeGraph& after, std::span<const Link> links);

/// A component before and one after that links tie together.
struct ComponentPair {
  std::uint32_t before = 0, after = 0;
  std::uint32_t links = 0;
  Point first;  ///< the lowest middle of a link, by x, then y: tells pairs apart alike in both senses of time
};
/// All tied pairs, ordered by (before, after).
std::vector<ComponentPair> component_pairs(const AttributeGraph& before, const AttributeGraph& after,
                                           const Components& parts_before, const Components& parts_after,
                                           const Gap& gap);

}  // namespace emberfold::graph::detail
