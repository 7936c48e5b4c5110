// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::mcmc {

/// Lists the sites of a frame where a stroke can change, by vertex index. Operator rates are per site.
struct OperatorSites {
  struct Pair {
    std::uint32_t a = 0, b = 0;
    auto operator<=>(const Pair&) const = default;
  };
  /// Patches inside a curve: without one of them the curve reads as split.
  std::vector<std::uint32_t> split_sites;
  /// (junction or corner, neighbour): the stroke can come apart between them.
  std::vector<Pair> disconnect_sites;
  /// Ends of two strokes, near each other and in line (turns below 30°).
  std::vector<Pair> merge_sites;
  /// (end of a stroke, nearest patch of another stroke), near each other and not in line.
  std::vector<Pair> connect_sites;
};

/// Number of patches that a separation leaves at a free end at least: fewer would be no stroke.
constexpr std::size_t kPiece = 4;

/// Finds all sites of a frame, ordered by vertex.
/// Two strokes have at most one site, where they come nearest, and none farther than `reach` px apart. O(n
/// log n).
OperatorSites find_sites(const graph::AttributeGraph& graph, const graph::Components& parts, double reach);

/// Returns the vector from an end's neighbour to the end, px: the direction in which the stroke goes on.
graph::Point end_direction(const graph::AttributeGraph& graph, std::uint32_t end);

/// Returns the turn from the stroke that ends at `pair.a` towards `pair.b`; rad, 0…π.
double turn_angle_towards(const graph::AttributeGraph& graph, const OperatorSites::Pair& pair);

}  // namespace emberfold::mcmc
