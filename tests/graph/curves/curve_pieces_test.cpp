// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::detail::divide_frame;
using graph::detail::FrameArcs;
using graph::detail::FramePieces;
using graph::detail::TimedJoint;

namespace {

graph::AttributeGraph straight(int patches) {
  test::Frame frame;
  frame.line(test::segment({10, 50}, {10 + 6.0 * (patches - 1), 50}, patches));
  return frame.graph();
}

/// A joint on the only arc, behind this patch.
TimedJoint on_arc(std::uint32_t index, double odds, bool found) {
  TimedJoint joint;
  joint.site = {.arc = 0, .index = index};
  joint.odds = odds, joint.found = found;
  return joint;
}

/// Where a straight line is cut: the patches before the cuts.
std::vector<std::uint32_t> cuts_of(const FramePieces& pieces) {
  std::vector<std::uint32_t> cuts;
  for (std::uint32_t v = 0; v + 1 < pieces.of_vertex.size(); ++v)
    if (pieces.of_vertex[v] != pieces.of_vertex[v + 1]) cuts.push_back(v);
  return cuts;
}

/// Four arms of two patches about a junction, to the right, down, to the left and up.
graph::AttributeGraph cross() {
  test::Frame frame;
  const auto middle = frame.line({{100, 100}});
  for (const graph::Point way : {graph::Point{1, 0}, {0, 1}, {-1, 0}, {0, -1}}) {
    const graph::Point from{100, 100};
    const auto arm = frame.line({from + way * 6, from + way * 12});
    frame.edge(middle, arm);
  }
  return frame.graph();
}

/// The joint of each two arms of the only knot with these odds, by the first vertices of the arms, 1, 3,
/// 5, 7.
std::vector<TimedJoint> at_knot(const FrameArcs& arcs,
                                const std::map<std::pair<std::uint32_t, std::uint32_t>, double>& odds) {
  std::vector<TimedJoint> joints;
  const auto& arms = arcs.knots.at(0).arms;
  for (std::uint32_t a = 0; a < arms.size(); ++a)
    for (std::uint32_t b = a + 1; b < arms.size(); ++b) {
      const auto both =
          std::minmax({graph::detail::end_of(arcs, arms[a]), graph::detail::end_of(arcs, arms[b])});
      TimedJoint joint;
      joint.site.knot = 0, joint.site.arm_a = a, joint.site.arm_b = b;
      const auto at = odds.find({both.first, both.second});
      joint.odds = at == odds.end() ? -30 : at->second;
      joints.push_back(joint);
    }
  return joints;
}

}  // namespace

TEST_CASE("An arc is cut where the odds are against one curve, and its probabilities are logistic",
          "[graph][curves]") {
  const auto graph = straight(20);
  const FrameArcs arcs(graph);
  const auto pieces = divide_frame(arcs, {on_arc(4, -1, true), on_arc(9, 0.5, true), on_arc(14, -40, false)});
  CHECK(pieces.count == 3);
  CHECK(cuts_of(pieces) == std::vector<std::uint32_t>{4, 14});
  REQUIRE(pieces.probability.size() == 3);
  CHECK_THAT(pieces.probability[0], test::WithinAbs(1 / (1 + std::exp(1.0)), 1e-12));
  CHECK_THAT(pieces.probability[1], test::WithinAbs(1 / (1 + std::exp(-0.5)), 1e-12));
  CHECK_THAT(pieces.probability[2], test::WithinAbs(1 / (1 + std::exp(30.0)), 1e-15));
}

TEST_CASE("Of cuts that lie close together those that the frame shows come first, then the surest",
          "[graph][curves]") {
  const auto graph = straight(30);
  const FrameArcs arcs(graph);
  const auto cuts = [&](const std::vector<TimedJoint>& joints) {
    return cuts_of(divide_frame(arcs, joints));
  };
  using Cuts = std::vector<std::uint32_t>;
  // Found ones are more than two patches apart, others more than five, to both sides.
  CHECK(cuts({on_arc(10, -3, true), on_arc(12, -2, true)}) == Cuts{10});
  CHECK(cuts({on_arc(10, -2, true), on_arc(12, -3, true)}) == Cuts{12});
  CHECK(cuts({on_arc(10, -3, true), on_arc(13, -2, true)}) == Cuts{10, 13});
  CHECK(cuts({on_arc(10, -3, false), on_arc(15, -2, false)}) == Cuts{10});
  CHECK(cuts({on_arc(10, -2, false), on_arc(15, -3, false)}) == Cuts{15});
  CHECK(cuts({on_arc(10, -3, false), on_arc(16, -2, false)}) == Cuts{10, 16});
  // What the frame shows wins over what is surer but only carried.
  CHECK(cuts({on_arc(10, -9, false), on_arc(12, -1, true)}) == Cuts{12});
  CHECK(cuts({on_arc(10, -1, true), on_arc(12, -9, false)}) == Cuts{10});
}

TEST_CASE("Arms of a knot are paired so that the odds together are the greatest", "[graph][curves]") {
  const auto graph = cross();
  const FrameArcs arcs(graph);
  const auto pieces =
      divide_frame(arcs, at_knot(arcs, {{{1, 5}, 2}, {{3, 7}, 1}, {{1, 3}, 2.5}, {{5, 7}, -30}}));
  CHECK(pieces.count == 2);
  CHECK(pieces.of_vertex[1] == pieces.of_vertex[5]);
  CHECK(pieces.of_vertex[3] == pieces.of_vertex[7]);
  CHECK(pieces.of_vertex[1] != pieces.of_vertex[3]);
}

TEST_CASE("The probability of a pair of arms is its share of all ways to pair them", "[graph][curves]") {
  const auto graph = cross();
  const FrameArcs arcs(graph);
  const std::map<std::pair<std::uint32_t, std::uint32_t>, double> odds{
      {{1, 3}, -0.4}, {{1, 5}, 1.1}, {{1, 7}, 0.2}, {{3, 5}, -1}, {{3, 7}, 0.6}, {{5, 7}, 0}};
  const auto joints = at_knot(arcs, odds);
  const auto pieces = divide_frame(arcs, joints);
  const auto weight = [&](std::uint32_t a, std::uint32_t b) { return std::exp(odds.at({a, b})); };
  // None, one pair, or two that have no arm in common.
  double all = 1 + weight(1, 3) * weight(5, 7) + weight(1, 5) * weight(3, 7) + weight(1, 7) * weight(3, 5);
  for (const auto& [both, nats] : odds) all += std::exp(nats);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const auto& arms = arcs.knots[0].arms;
    const auto [a, b] = std::minmax({graph::detail::end_of(arcs, arms[joints[k].site.arm_a]),
                                     graph::detail::end_of(arcs, arms[joints[k].site.arm_b])});
    double other = 1;
    for (const auto& [both, nats] : odds)
      if (both.first != a && both.first != b && both.second != a && both.second != b) other += std::exp(nats);
    CHECK_THAT(pieces.probability[k], test::WithinAbs(weight(a, b) * other / all, 1e-12));
  }
}
