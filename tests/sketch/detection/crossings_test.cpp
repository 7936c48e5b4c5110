// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::Point;
using sketch::Chain;
using sketch::CreaseKind;
using sketch::CurveNetwork;

namespace {

/// A straight curve from a to b, a point a pixel.
Chain straight_chain(Point a, Point b, CreaseKind kind = CreaseKind::ridge) {
  Chain chain{kind, {}, false, {0, 0}};
  const int steps = static_cast<int>(graph::distance(a, b));
  for (int k = 0; k <= steps; ++k) {
    sketch::CreasePoint point;
    point.position = a + (b - a) * (double(k) / steps);
    chain.points.push_back(point);
  }
  return chain;
}

Point place_of(const CurveNetwork& network, const sketch::Contact& contact) {
  return network.chains[contact.chain].points[contact.point].position;
}

}  // namespace

TEST_CASE("Lines of one sign that run through each other meet where they cross") {
  CurveNetwork network;
  network.chains = {straight_chain({10, 40.3}, {90, 40.3}), straight_chain({50.4, 10}, {50.4, 70}),
                    straight_chain({20.6, 20}, {20.6, 60}, CreaseKind::valley),
                    straight_chain({70.6, 45}, {70.6, 60})};
  const auto merged = sketch::merge_crossings(network);
  REQUIRE(merged.meetings.size() == 1);
  REQUIRE(merged.meetings[0].size() == 2);
  CHECK(merged.meetings[0][0].chain == 0);
  CHECK(merged.meetings[0][1].chain == 1);
  for (const auto& contact : merged.meetings[0])
    CHECK(graph::distance(place_of(merged, contact), {50.4, 40.3}) <= 1);
}

TEST_CASE("A meeting of the same lines within 8 px is their crossing, one farther off is not") {
  for (const auto& [away, meetings] : {std::pair(6, 1U), {12, 2U}}) {
    CurveNetwork network;
    network.chains = {straight_chain({10, 40.3}, {90, 40.3}), straight_chain({50.4, 10}, {50.4, 70})};
    network.meetings = {{{0, static_cast<std::size_t>(40 + away)}, {1, static_cast<std::size_t>(30 + away)}}};
    CHECK(sketch::merge_crossings(network).meetings.size() == meetings);
    // Of other lines it is none.
    network.chains.push_back(straight_chain({50, 80}, {60, 80}));
    network.meetings = {{{0, 40}, {2, 0}}};
    CHECK(sketch::merge_crossings(network).meetings.size() == 2);
  }
}

TEST_CASE("Two pairs of ends whose connections cross are one meeting of four, steps are left alone") {
  for (const auto kind : {CreaseKind::ridge, CreaseKind::step}) {
    CurveNetwork network;
    network.chains = {straight_chain({10, 40}, {46, 40}, kind), straight_chain({54, 40}, {90, 40}, kind),
                      straight_chain({50, 10}, {50, 36}, kind), straight_chain({50, 44}, {50, 70}, kind)};
    network.meetings = {{{0, 36}, {1, 0}}, {{2, 26}, {3, 0}}};
    const auto merged = sketch::merge_crossings(network);
    REQUIRE(merged.meetings.size() == (kind == CreaseKind::ridge ? 1U : 2U));
    CHECK(merged.meetings[0].size() == (kind == CreaseKind::ridge ? 4U : 2U));
  }
}
