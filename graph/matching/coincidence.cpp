// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/coincidence.hpp"

#include <cmath>

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

}  // namespace emberfold::graph
