// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_strokes.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "graph/matching/coincidence.hpp"

namespace emberfold::pipeline {

namespace {

using graph::AttributeGraph;
using graph::SubgraphId;

/// Returns the stroke of the patch that best coincides with a given patch.
std::optional<SubgraphId> stroke_at(const AttributeGraph& named, const graph::Patch& patch) {
  std::optional<SubgraphId> found;
  double nearest = std::numeric_limits<double>::max();
  for (const graph::Vertex& vertex : named.vertices()) {
    const auto apart = graph::coincidence(vertex.patch, patch);
    if (!apart || *apart >= nearest) continue;
    nearest = *apart;
    found = vertex.subgraph;
  }
  return found;
}

/// Returns the name of the stroke that coincides with a stroke of an interpretation, nearest to a place.
std::optional<SubgraphId> name_of(SubgraphId stroke, graph::Point place, const AttributeGraph& reading,
                                  const AttributeGraph& named) {
  std::vector<std::pair<double, std::uint32_t>> order;  // px from the place, vertex
  for (std::uint32_t v = 0; v < reading.size(); ++v)
    if (reading.vertices()[v].subgraph == stroke)
      order.emplace_back(distance(reading.patch(v).position, place), v);
  std::ranges::sort(order);
  for (const auto& [apart, v] : order)
    if (const auto name = stroke_at(named, reading.patch(v))) return name;
  return std::nullopt;
}

std::vector<SubgraphId> names_of(const std::vector<SubgraphId>& strokes, graph::Point place,
                                 const AttributeGraph& reading, const AttributeGraph& named) {
  std::vector<SubgraphId> names;
  for (const SubgraphId stroke : strokes)
    if (const auto name = name_of(stroke, place, reading, named))
      if (std::ranges::find(names, *name) == names.end()) names.push_back(*name);
  std::ranges::sort(names);
  return names;
}

}  // namespace

void name_strokes(graph::Event& event, const MotionIndex& reading, const MotionIndex& named) {
  const int before = event.frame - 1, after = event.frame;
  event.before = names_of(event.before, event.position, reading.graph(before), named.graph(before));
  event.after = names_of(event.after, event.position, reading.graph(after), named.graph(after));
}

}  // namespace emberfold::pipeline
