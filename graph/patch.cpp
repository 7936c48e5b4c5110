// SPDX-License-Identifier: Apache-2.0
#include "graph/patch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace emberfold::graph {

namespace {
constexpr std::array<std::string_view, 11> kNames = {"ridge",      "valley",     "bar",        "step",
                                                     "corner",     "terminator", "l_junction", "t_junction",
                                                     "y_junction", "crossing",   "anchor"};
}

std::string_view name(PatchType type) {
  return kNames[static_cast<std::size_t>(type)];
}

std::optional<PatchType> patch_type(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<PatchType>(found - kNames.begin());
}

Patch make_anchor(Point pixel, const Level& level) {
  Patch patch;
  patch.type = PatchType::anchor;
  patch.position = pixel;
  patch.middle = level;
  return patch;
}

bool joins_outlines(const Patch& a, const Patch& b) {
  constexpr double kAlong = 50 * std::numbers::pi / 180;
  if (!on_step(a) || !on_step(b)) return false;
  const Point way = b.position - a.position;
  const double direction = std::atan2(way.y, way.x);
  return norm(way) > kLongestGap || (orientation_difference(a.theta, direction) > kAlong &&
                                     orientation_difference(b.theta, direction) > kAlong);
}

bool closes_at_border(const Patch& patch) {
  return on_step(patch) && patch.contrast == 0;
}

bool is_seen(const Patch& a, const Patch& b) {
  return !(closes_at_border(a) && closes_at_border(b)) && !joins_outlines(a, b);
}

bool same_kind(const Patch& a, const Patch& b) {
  const bool step_a = on_step(a), step_b = on_step(b);
  return step_a == step_b && (step_a || (a.contrast > 0) == (b.contrast > 0));
}

double orientation_difference(double theta_a, double theta_b) {
  const double d = std::fmod(std::abs(theta_a - theta_b), std::numbers::pi);
  return std::min(d, std::numbers::pi - d);
}

}  // namespace emberfold::graph
