// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_union.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::detail::ClipArcs;
using graph::detail::FrameArcs;
using graph::detail::Identities;
using graph::detail::JointScales;
using graph::detail::TimedJoint;

namespace {

constexpr JointScales kScales{{0.1, 0.1, 0.8}, {0.1, 0.1, 0.5}, 0.15};

/// As many frames of one graph, with the same joints in all, and the names of its patches.
struct RepeatedFrame {
  graph::AttributeGraph graph;
  std::vector<std::vector<TimedJoint>> joints;
  Identities identity;

  /// Returns how many names there are after the union.
  [[nodiscard]] std::size_t names_left() const {
    ClipArcs clip;
    for (std::size_t t = 0; t < identity.size(); ++t) clip.frames.emplace_back(graph);
    Identities united = identity;
    graph::detail::unite_identities(clip, joints, kScales, united);
    std::vector<std::uint32_t> all;
    for (const auto& frame : united) all.insert(all.end(), frame.begin(), frame.end());
    std::ranges::sort(all);
    return static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
  }
};

graph::AttributeGraph row_of_twelve() {
  test::Frame frame;
  frame.line(test::segment({10, 50}, {76, 50}, 12));
  return frame.graph();
}

/// A joint on the arc behind this patch, whose first side is by so much stronger; it turns aside.
TimedJoint joint_behind(std::uint32_t index, double stronger, double evidence = 0) {
  TimedJoint joint;
  joint.site = {.arc = 0, .index = index};
  joint.look.stronger = stronger, joint.look.patches = 0.5, joint.look.turn = 1;
  joint.evidence = evidence;
  return joint;
}

std::vector<std::uint32_t> names(std::uint32_t front, std::uint32_t back) {
  std::vector<std::uint32_t> result(12, front);
  std::fill(result.begin() + 6, result.end(), back);
  return result;
}

}  // namespace

TEST_CASE("Identities are united by their usual difference, whichever side each is on", "[graph][curves]") {
  const auto graph = row_of_twelve();
  const auto joints = [](double first, double second, double third) {
    return std::vector<std::vector<TimedJoint>>{
        {joint_behind(5, first)}, {joint_behind(5, second)}, {joint_behind(5, third)}};
  };
  const Identities kept{names(1, 2), names(1, 2), names(1, 2)}, turned{names(1, 2), names(1, 2), names(2, 1)};
  CHECK(RepeatedFrame{graph, joints(0, 0, 0), kept}.names_left() == 1);
  CHECK(RepeatedFrame{graph, joints(1.5, 1.5, 1.5), kept}.names_left() == 2);
  // 1.5, 0 and −1.5 are 0 as a rule, 1.5, 0 and 1.5 are not.
  CHECK(RepeatedFrame{graph, joints(1.5, 0, 1.5), turned}.names_left() == 1);
  CHECK(RepeatedFrame{graph, joints(1.5, 0, 1.5), kept}.names_left() == 2);
  CHECK(RepeatedFrame{graph, joints(1.5, 0, -1.5), turned}.names_left() == 2);
}

TEST_CASE("Of several joints of two identities in a frame the likeliest counts", "[graph][curves]") {
  // 1 1 1 1 2 2 2 2 1 1 1 1
  std::vector<std::uint32_t> row = names(1, 1);
  std::fill(row.begin() + 4, row.begin() + 8, 2);
  const Identities identity(5, row);
  const auto both = [&](double of_first, double of_second) {
    const std::vector<TimedJoint> joints{joint_behind(3, 0, of_first), joint_behind(7, 1.5, of_second)};
    return RepeatedFrame{row_of_twelve(), std::vector<std::vector<TimedJoint>>(5, joints), identity}
        .names_left();
  };
  CHECK(both(5, -5) == 1);
  CHECK(both(-5, 5) == 2);
}

TEST_CASE("Frames that have two identities apart speak against their union", "[graph][curves]") {
  std::vector<std::vector<TimedJoint>> joints(30);
  Identities identity(30, names(1, 2));
  joints[0] = {joint_behind(5, 0)};
  CHECK(RepeatedFrame{row_of_twelve(), joints, identity}.names_left() == 2);
  for (std::size_t t = 1; t < 30; ++t) identity[t] = names(t % 2 == 0 ? 1 : 2, t % 2 == 0 ? 1 : 2);
  CHECK(RepeatedFrame{row_of_twelve(), joints, identity}.names_left() == 1);
}

TEST_CASE("At a knot where one of two identities goes on by itself they are not united", "[graph][curves]") {
  test::Frame frame;
  const auto bar = frame.line(test::segment({40, 50}, {100, 50}, 11));
  const auto stem = frame.line(test::segment({70, 56}, {70, 86}, 6));
  frame.edge(bar + 5, stem);
  const auto graph = frame.graph();
  const FrameArcs arcs(graph);
  REQUIRE(arcs.knots.size() == 1);
  REQUIRE(arcs.knots[0].arms.size() == 3);
  const auto united = [&](std::uint32_t left, std::uint32_t right, std::uint32_t below) {
    std::vector<std::uint32_t> row(17, left);
    std::fill(row.begin() + 6, row.begin() + 11, right);
    std::fill(row.begin() + 11, row.end(), below);
    std::vector<TimedJoint> joints;
    for (std::uint32_t a = 0; a < 3; ++a)
      for (std::uint32_t b = a + 1; b < 3; ++b) {
        auto& joint = joints.emplace_back();
        joint.site = {.knot = 0, .arm_a = a, .arm_b = b};
        joint.look.patches = 0.5;
      }
    return RepeatedFrame{graph, std::vector<std::vector<TimedJoint>>(6, joints), Identities(6, row)}
        .names_left();
  };
  CHECK(united(1, 1, 2) == 2);
  CHECK(united(1, 2, 2) == 2);
  CHECK(united(1, 2, 3) < 3);
}
