// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/joint_evidence.hpp"

#include <cmath>
#include <numbers>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::detail::FrameArcs;
using graph::detail::JointLook;
using graph::detail::JointScales;
using graph::detail::look_at_joint;

namespace {

constexpr double kRight = std::numbers::pi / 2;

double log_of_contrast(double contrast) {
  return std::log(1 + contrast);
}

}  // namespace

TEST_CASE("The sides of a joint are told by the medians of their patches", "[graph][curves]") {
  test::Frame frame;
  frame.line(test::segment({10, 50}, {70, 50}, 11));
  for (std::uint32_t v = 6; v < 11; ++v) frame.vertices[v].patch.contrast = 90;
  frame.vertices[6].patch.contrast = 60;  // where both sides mix
  frame.vertices[10].patch.contrast = 5;  // a tip, which fades
  frame.vertices[2].patch.contrast = 1;   // an outlier
  const auto graph = frame.graph();
  const FrameArcs arcs(graph);
  const auto look = look_at_joint(arcs, {.arc = 0, .index = 5}, {{}});
  CHECK_THAT(look.stronger, test::WithinAbs(log_of_contrast(40) - log_of_contrast(90), 1e-12));
  CHECK_THAT(look.wider, test::WithinAbs(0, 1e-12));
  CHECK_THAT(look.patches, test::WithinAbs(1 / 4.0 + 1 / 3.0, 1e-12));
  CHECK_THAT(look.turn, test::WithinAbs(0, 1e-9));
  CHECK(!look.other_kind);
}

TEST_CASE("Nothing beyond a cut tells of a joint, on a ring nor on an open arc", "[graph][curves]") {
  test::Frame frame;
  frame.line(test::segment({10, 50}, {100, 50}, 16));
  const auto graph = frame.graph();
  const FrameArcs arcs(graph);
  // Cuts behind 3 and behind 11: of 4 … 7 and 8 … 11 all but the first count.
  CHECK_THAT(look_at_joint(arcs, {.arc = 0, .index = 7}, {{3, 11}}).patches, test::WithinAbs(2 / 3.0, 1e-12));
  CHECK_THAT(look_at_joint(arcs, {.arc = 0, .index = 7}, {{4, 9}}).patches,
             test::WithinAbs(1 / 2.0 + 1, 1e-12));

  test::Frame round;
  std::vector<graph::Point> points;
  for (int k = 0; k < 12; ++k)
    points.push_back({100 + 12 * std::cos(kRight * k / 3), 100 + 12 * std::sin(kRight * k / 3)});
  const auto first = round.line(points);
  round.edge(first, first + 11);
  const auto ring = round.graph();
  const FrameArcs closed(ring);
  REQUIRE(closed.arcs[0].closed);
  const auto place = [&](std::uint32_t index) { return closed.arcs[0].path[index % 12]; };
  REQUIRE(place(0) != place(1));
  // A joint behind 9, a cut behind 11, where the ring closes, and one behind 7: two patches on either side.
  CHECK_THAT(look_at_joint(closed, {.arc = 0, .index = 9}, {{7, 11}}).patches, test::WithinAbs(2, 1e-12));
  // A joint behind 1, cuts behind 10 and behind 4: three on either side, one of them across the end.
  CHECK_THAT(look_at_joint(closed, {.arc = 0, .index = 1}, {{4, 10}}).patches,
             test::WithinAbs(1 / 2.0 + 1 / 2.0, 1e-12));
}

TEST_CASE("A joint turns by the angle between its sides, and where tips are far by that to their line",
          "[graph][curves]") {
  for (const double bend : {0.3, 1.2, 2.0}) {
    test::Frame frame;
    auto points = test::segment({40, 60}, {100, 60}, 11);
    for (const auto& p : test::segment(
             {106, 60}, graph::Point{106, 60} + graph::Point{std::cos(bend), std::sin(bend)} * 60, 11))
      points.push_back(p);
    frame.line(points);
    const auto graph = frame.graph();
    const FrameArcs arcs(graph);
    CHECK_THAT(look_at_joint(arcs, {.arc = 0, .index = 10}, {{}}).turn, test::WithinAbs(bend, 1e-9));
  }
  // Parallel lines with a gap of 12 px aslant between them: the gap turns by its own slope on either side.
  test::Frame frame;
  auto points = test::segment({40, 60}, {100, 60}, 11);
  for (const auto& p : test::segment({106, 70}, {166, 70}, 11)) points.push_back(p);
  frame.line(points);
  const auto graph = frame.graph();
  const FrameArcs arcs(graph);
  CHECK_THAT(look_at_joint(arcs, {.arc = 0, .index = 10}, {{}}).turn,
             test::WithinAbs(std::atan2(10, 6), 1e-9));
  // The second side turns back behind the gap: by more against the gap than against the first side.
  const auto aimed = [](double angle) { return graph::Point{std::cos(angle), std::sin(angle)}; };
  test::Frame bent;
  points = test::segment({40, 60}, {100, 60}, 11);
  const graph::Point behind = graph::Point{100, 60} + aimed(-0.5) * 12;
  for (const auto& p : test::segment(behind, behind + aimed(0.3) * 60, 11)) points.push_back(p);
  bent.line(points);
  const auto second = bent.graph();
  const FrameArcs turned(second);
  CHECK_THAT(look_at_joint(turned, {.arc = 0, .index = 10}, {{}}).turn, test::WithinAbs(0.8, 1e-9));
}

TEST_CASE("A single patch beside a joint points at it, whichever way it is told", "[graph][curves]") {
  for (const double theta : {0.0, std::numbers::pi}) {
    test::Frame frame;
    frame.line(test::segment({40, 60}, {100, 60}, 11));
    frame.vertices[10].patch.theta = theta;  // in either sense, the patch lies along the line
    const auto graph = frame.graph();
    const FrameArcs arcs(graph);
    CHECK_THAT(look_at_joint(arcs, {.arc = 0, .index = 9}, {{}}).turn, test::WithinAbs(0, 1e-9));
  }
}

TEST_CASE("Sides that are alike speak for one curve, sides that differ for two", "[graph][curves]") {
  const JointScales scales{{0.1, 0.1, 0.8}, {0.1, 0.1, 0.5}, 0.15};
  JointLook look;
  look.patches = 0.5;
  const auto alike = joint_evidence(look, scales);
  CHECK(alike.properties > 1);
  CHECK(alike.turn > 1);
  CHECK_THAT(alike.total(), test::WithinAbs(alike.properties + alike.turn, 1e-12));
  // Two normal laws and, where anything goes, what both have in common; the turn is even over half a turn.
  const auto normal = [](double x, double sd) { return std::exp(-0.5 * x * x / (sd * sd)) / sd; };
  const auto ratio = [&](double apart, double same, double two, double outliers) {
    const double out = normal(apart, std::max(0.5, two));
    return std::log((0.97 * normal(apart, same) + 0.03 * out) /
                    ((1 - outliers) * normal(apart, two) + outliers * out));
  };
  for (const double stronger : {0.0, 0.3, -0.9, 2.0})
    for (const double wider : {0.0, 0.4, -1.0})
      for (const double turn : {0.0, 0.4, 2.0}) {
        look.stronger = stronger, look.wider = wider, look.turn = turn;
        const double along = std::sqrt(0.01 + 0.01 * 0.5);
        const double doubtful = std::sqrt(along * along + wider * wider);
        const auto found = joint_evidence(look, scales);
        CHECK_THAT(found.properties,
                   test::WithinAbs(ratio(stronger, doubtful, std::hypot(doubtful, std::sqrt(2) * 0.8), 0.2) +
                                       ratio(wider, along, std::hypot(along, std::sqrt(2) * 0.5), 0.03),
                                   1e-9));
        const double half_normal = std::sqrt(2 / std::numbers::pi) * normal(turn, 0.15);
        CHECK_THAT(found.turn, test::WithinAbs(std::log(0.9 * half_normal * std::numbers::pi + 0.1), 1e-9));
      }
  look.other_kind = true;
  CHECK(joint_evidence(look, scales).total() == -6);
}
