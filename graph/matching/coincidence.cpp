// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/coincidence.hpp"

#include <cmath>
#include <vector>

namespace emberfold::graph {

namespace {

constexpr double kAlong = 4.5;     // px, of a patch's length and what its place may slip along the stroke
constexpr double kAcross = 3;      // px
constexpr double kParallel = 0.6;  // rad

bool is_meeting(const Patch& patch) {
  using enum PatchType;
  return patch.type == corner || patch.type == l_junction || patch.type == t_junction ||
         patch.type == y_junction || patch.type == crossing;
}

std::vector<Point> places_of(const AttributeGraph& graph) {
  std::vector<Point> points;
  for (const Vertex& v : graph.vertices()) points.push_back(v.patch.position);
  return points;
}

}  // namespace

std::optional<double> coincidence(const Patch& patch, const Patch& other) {
  const Point off = other.position - patch.position;
  if (is_meeting(patch) || is_meeting(other)) {
    const double apart = norm(off);
    return apart <= kAlong ? std::optional(apart) : std::nullopt;
  }
  if (!same_kind(patch, other)) return std::nullopt;
  const Point tangent{std::cos(patch.theta), std::sin(patch.theta)};
  const double along = std::abs(dot(off, tangent)), across = std::abs(off.y * tangent.x - off.x * tangent.y);
  if (along > kAlong || across > kAcross || orientation_difference(patch.theta, other.theta) > kParallel)
    return std::nullopt;
  return along + across;
}

CoincidenceIndex::CoincidenceIndex(const AttributeGraph& graph)
    : graph_(&graph), places_(places_of(graph), kCoincidence) {}

std::optional<std::uint32_t> CoincidenceIndex::find(const Patch& patch) const {
  std::optional<std::uint32_t> best;
  double least = 0;
  for (const std::uint32_t v : places_.find_near(patch.position)) {
    const auto apart = coincidence(patch, graph_->patch(v));
    if (apart && (!best || *apart < least)) least = *apart, best = v;
  }
  return best;
}

}  // namespace emberfold::graph
