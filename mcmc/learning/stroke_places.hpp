// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::mcmc {

/// Returns the place of the patch nearest the mean of a stroke's places, px; the first of equally near ones.
graph::Point stroke_middle(const graph::AttributeGraph& graph, std::span<const std::uint32_t> stroke);

/// Returns the distance between the nearest patches of two strokes of a frame, px; infinite where one is
/// absent.
double gap_between_strokes(const graph::AttributeGraph& graph, graph::SubgraphId a, graph::SubgraphId b);

/// Lists the vertices of each component.
std::vector<std::vector<std::uint32_t>> vertices_by_stroke(const graph::Components& parts);

}  // namespace emberfold::mcmc
