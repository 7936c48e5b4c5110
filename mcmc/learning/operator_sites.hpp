// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::mcmc {

/// The places of a frame where a stroke can change, by vertex index: what the operator rates are per.
struct Sites {
  struct Pair {
    std::uint32_t a = 0, b = 0;
    auto operator<=>(const Pair&) const = default;
  };
  std::vector<std::uint32_t> inner;  ///< patches inside a curve without which it is read as split
  std::vector<Pair> arms;    ///< (junction or corner, neighbour): the stroke can come apart between them
  std::vector<Pair> facing;  ///< ends of two strokes, near and in line (turns below 30°): they can merge
  std::vector<Pair>
      beside;  ///< (end of a stroke, nearest patch of another), near, in no line: they can connect
};

/// Nothing comes apart nearer to a free end than this, patches: the piece would be no stroke.
constexpr std::size_t kPiece = 4;

/// Two strokes are at most one site, where they come nearest; farther than `reach` px apart they are none.
/// Ordered by vertex. O(n log n).
Sites sites(const graph::AttributeGraph& graph, const graph::Components& parts, double reach);

/// From its neighbour to the end of a stroke, px: where the stroke would go on.
graph::Point outwards(const graph::AttributeGraph& graph, std::uint32_t end);

/// How far the stroke that ends at `pair.a` would have to turn there towards `pair.b`; rad, 0…π.
double turn_towards(const graph::AttributeGraph& graph, const Sites::Pair& pair);

}  // namespace emberfold::mcmc
