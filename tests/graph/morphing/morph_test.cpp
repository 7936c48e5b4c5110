// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/morph.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.hpp"
#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using graph::AttributeGraph;
using graph::MorphOptions;
using graph::Point;
using std::numbers::pi;

namespace {

AttributeGraph line(Point a, Point b, int patches, double contrast = 40) {
  test::Frame frame;
  frame.line(test::segment(a, b, patches), contrast);
  return frame.graph();
}

AttributeGraph step_line(Point a, Point b, float left, float right) {
  test::Frame frame;
  frame.line(test::segment(a, b, 7));
  for (auto& v : frame.vertices) {
    v.patch.type = graph::PatchType::step, v.patch.width = 0, v.patch.contrast = double{right} - double{left};
    v.patch.left.fill(left), v.patch.right.fill(right), v.patch.middle.fill((left + right) / 2);
  }
  return frame.graph();
}

AttributeGraph ring(Point centre, double radius, double squeeze, int patches, double begin = 0) {
  test::Frame frame;
  std::vector<Point> points;
  for (int k = 0; k < patches; ++k) {
    const double angle = begin + 2 * pi * k / patches;
    points.push_back(centre + Point{radius * std::cos(angle), squeeze * radius * std::sin(angle)});
  }
  frame.line(points);
  frame.edge(0, static_cast<std::uint32_t>(patches - 1));
  return frame.graph();
}

/// Three arms that meet, turned by an angle.
AttributeGraph star(Point centre, double turned) {
  test::Frame frame;
  frame.line({centre});
  for (int arm = 0; arm < 3; ++arm) {
    const double angle = turned + 2 * pi * arm / 3;
    const Point out{std::cos(angle), std::sin(angle)};
    frame.edge(0, frame.line(test::segment(centre + out * 5, centre + out * (30 + 8 * arm), 6)));
  }
  return frame.graph();
}

graph::Morph morph(const AttributeGraph& a, const AttributeGraph& b, const MorphOptions& options = {}) {
  return graph::morph(a, b, 320, 240, 25, options);
}

double curve_length(const AttributeGraph& graph) {
  double sum = 0;
  for (const auto& [a, b] : graph.edges())
    sum += distance(graph.patch(graph.index_of(a)).position, graph.patch(graph.index_of(b)).position);
  return sum;
}

Point middle(const AttributeGraph& graph) {
  Point sum;
  for (const auto& v : graph.vertices()) sum = sum + v.patch.position;
  return sum * (1.0 / static_cast<double>(graph.size()));
}

/// Positions in an order that does not depend on the ids.
std::vector<std::pair<double, double>> places(const AttributeGraph& graph) {
  std::vector<std::pair<double, double>> result;
  for (const auto& v : graph.vertices()) {
    const auto rounded = [](double x) { return std::round(1e6 * x) / 1e6 + 0.0; };
    result.emplace_back(rounded(v.patch.position.x), rounded(v.patch.position.y));
  }
  std::ranges::sort(result);
  return result;
}

bool same_but_for_ids(const AttributeGraph& a, const AttributeGraph& b) {
  if (a.size() != b.size() || a.edges().size() != b.edges().size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(a.patch(i) == b.patch(i))) return false;
    if (!std::ranges::equal(a.neighbours(i), b.neighbours(i))) return false;
  }
  return true;
}

AttributeGraph unlike_graph(std::uint64_t seed) {
  core::Rng rng(seed);
  return test::random_graph(rng, 12, 2);
}

}  // namespace

TEST_CASE("The morph of a graph to itself has no length and stands still", "[morph]") {
  const auto still = star({100, 90}, 0.3);
  const auto made = morph(still, still);
  CHECK(made.length == Approx(0).margin(1e-12));
  CHECK(made.moved == 3);
  CHECK(made.died + made.born == 0);
  for (const auto& frame : made.motion.sketch.frames) {
    CHECK(places(frame) == places(still));
    CHECK(frame.edges().size() == still.edges().size());
  }
}

TEST_CASE("The ends of a morph are the two graphs, anchors left out", "[morph]") {
  core::Rng rng(3);
  const auto a = unlike_graph(1), b = unlike_graph(2);
  const auto made = morph(test::with_anchors(a, rng, 5), b, {.frames = 7});
  REQUIRE(made.motion.sketch.frames.size() == 7);
  CHECK(same_but_for_ids(made.motion.sketch.frames.front(), a));
  CHECK(same_but_for_ids(made.motion.sketch.frames.back(), b));
  CHECK_NOTHROW(graph::validate(made.motion));
  for (std::size_t t = 0; t < 7; ++t) CHECK(made.opacity[t].size() == made.motion.sketch.frames[t].size());
}

TEST_CASE("A line that is elsewhere moves there at an even speed", "[morph]") {
  const auto made = morph(line({20, 30}, {60, 30}, 9), line({80, 110}, {120, 110}, 9), {.frames = 11});
  CHECK(made.length == Approx(100));
  for (int t = 0; t < 11; ++t) {
    const auto& frame = made.motion.sketch.frames[static_cast<std::size_t>(t)];
    CHECK(middle(frame).x == Approx(40 + 6 * t));
    CHECK(middle(frame).y == Approx(30 + 8 * t));
    CHECK(curve_length(frame) == Approx(40));
    if (t > 0) CHECK(made.motion.links[static_cast<std::size_t>(t)].size() == 9);
  }
}

TEST_CASE("A line that is turned keeps its length", "[morph]") {
  const double angle = 1.3;
  const Point half{20 * std::cos(angle), 20 * std::sin(angle)};
  const auto made =
      morph(line({80, 60}, {120, 60}, 9), line(Point{100, 60} - half, Point{100, 60} + half, 9));
  CHECK(made.length == Approx(40 / std::sqrt(12) * angle));
  for (const auto& frame : made.motion.sketch.frames) {
    CHECK(curve_length(frame) == Approx(40));
    CHECK(middle(frame).x == Approx(100));
  }
  const auto& at_half = made.motion.sketch.frames[15];
  CHECK(at_half.patch(4).theta == Approx(angle * 15 / 29));
}

TEST_CASE("An arc straightens without a kink or a change of length", "[morph]") {
  test::Frame arc;
  std::vector<Point> points;
  for (int k = 0; k <= 12; ++k)
    points.push_back(Point{100, 100} + Point{30 * std::cos(pi * k / 12), 30 * std::sin(pi * k / 12)});
  arc.line(points);
  const double length = curve_length(arc.graph());
  const auto made =
      morph(arc.graph(), line({100 - length / 2, 120}, {100 + length / 2, 120}, 13), {.frames = 9});
  for (const auto& frame : made.motion.sketch.frames) CHECK(curve_length(frame) == Approx(length));
}

TEST_CASE("A line goes to another of fewer patches, as long as the mean of the logarithms", "[morph]") {
  const auto made = morph(line({20, 30}, {60, 30}, 9), line({20, 30}, {180, 30}, 4), {.frames = 5});
  CHECK(curve_length(made.motion.sketch.frames[2]) == Approx(80));
  CHECK(made.motion.sketch.frames[3].size() == 9);
  CHECK(made.motion.sketch.frames[4].size() == 4);
}

TEST_CASE("A line that was drawn the other way round does not move", "[morph]") {
  CHECK(morph(line({20, 30}, {60, 40}, 9), line({60, 40}, {20, 30}, 9)).length == Approx(0).margin(1e-9));
}

TEST_CASE("A step keeps its brighter side to one hand", "[morph]") {
  const auto bright_below = step_line({20, 30}, {60, 30}, 50, 150);
  const auto drawn_back = step_line({60, 30}, {20, 30}, 150, 50);
  const auto bright_above = step_line({20, 30}, {60, 30}, 150, 50);
  CHECK(morph(bright_below, drawn_back).length == Approx(0).margin(1e-9));
  const auto made = morph(bright_below, bright_above);
  CHECK(made.length == Approx(40 / std::sqrt(12) * pi));
  for (const auto& frame : made.motion.sketch.frames)
    for (const auto& v : frame.vertices()) CHECK(std::abs(v.patch.contrast) == Approx(100));
}

TEST_CASE("A ring is found wherever it begins", "[morph]") {
  const auto a = ring({90, 90}, 30, 0.5, 24), b = ring({130, 90}, 30, 0.5, 24, 2 * pi * 5 / 24);
  const auto made = morph(a, b, {.frames = 5});
  CHECK(made.length == Approx(40).epsilon(1e-6));
  for (const auto& frame : made.motion.sketch.frames) {
    CHECK(frame.edges().size() == 24);
    CHECK(curve_length(frame) == Approx(curve_length(a)).epsilon(1e-6));
  }
}

TEST_CASE("Arms that meet in both graphs stay joined on the way", "[morph]") {
  const auto made = morph(star({100, 90}, 0.2), star({150, 100}, 0.7), {.frames = 9});
  CHECK(made.moved == 3);
  for (const auto& frame : made.motion.sketch.frames) {
    CHECK(components(frame).count == 1);
    CHECK(frame.size() == 19);
  }
}

TEST_CASE("The reversed morph is the morph between the exchanged graphs", "[morph]") {
  const auto a = unlike_graph(5), b = unlike_graph(6);
  const auto there = morph(a, b, {.frames = 9}), back = morph(b, a, {.frames = 9});
  CHECK(there.length > 1);
  CHECK(there.length == Approx(back.length).epsilon(1e-9));
  CHECK((there.moved > 0 && there.moved == back.moved));
  CHECK((there.died == back.born && there.born == back.died));
  for (std::size_t t = 0; t < 9; ++t)
    CHECK(places(there.motion.sketch.frames[t]) == places(back.motion.sketch.frames[8 - t]));
}

TEST_CASE("Strokes without partner fade out in the first half and in in the second", "[morph]") {
  test::Frame two;
  two.line(test::segment({20, 30}, {60, 30}, 9));
  two.line(test::segment({20, 200}, {60, 200}, 9), -40);  // nothing dark in the other graph
  const auto one = line({20, 40}, {60, 40}, 9);
  const auto made = morph(two.graph(), one, {.frames = 9});
  CHECK((made.moved == 1 && made.died == 1 && made.born == 0));
  const std::vector<std::size_t> sizes{18, 18, 18, 18, 9, 9, 9, 9, 9};
  for (std::size_t t = 0; t < 9; ++t) {
    CHECK(made.motion.sketch.frames[t].size() == sizes[t]);
    const float faintest = *std::ranges::min_element(made.opacity[t]);
    CHECK(faintest == Approx(t < 4 ? 1 - double(t) / 4 : 1));
  }
  const auto back = morph(one, two.graph(), {.frames = 9});
  CHECK((back.born == 1 && back.length == Approx(made.length)));
  CHECK(back.motion.sketch.frames[4].size() == 9);
  CHECK(back.motion.sketch.frames[5].size() == 18);
  // Half of three lines goes 200 px, which fading counts as; the other two go 10 px.
  CHECK(made.length == Approx(std::sqrt((40 * 100. + 20 * 200. * 200.) / 60)));
}

TEST_CASE("Far strokes are paired, beyond the farthest they fade", "[morph]") {
  const auto a = line({20, 10}, {60, 10}, 9);
  const auto near = line({20, 209}, {60, 209}, 9), far = line({20, 211}, {60, 211}, 9);
  CHECK(morph(a, near).moved == 1);
  CHECK(morph(a, near).length == Approx(199));
  CHECK(morph(a, far).moved == 0);
  CHECK(morph(a, far).length == Approx(200));
}

TEST_CASE("Pairs are those of the least sum, not each one's nearest", "[morph]") {
  test::Frame a, b;
  a.line(test::segment({100, 20}, {140, 20}, 9));
  a.line(test::segment({100, 60}, {140, 60}, 9));
  b.line(test::segment({100, 58}, {140, 58}, 9));
  b.line(test::segment({100, 98}, {140, 98}, 9));
  const auto made = morph(a.graph(), b.graph());
  CHECK(made.length == Approx(38));
}

TEST_CASE("Empty graphs have a morph", "[morph]") {
  CHECK(morph({}, {}).length == 0);
  const auto made = morph({}, line({20, 30}, {60, 30}, 9), {.frames = 3});
  CHECK(made.length == Approx(200));
  CHECK(made.motion.sketch.frames[1].empty());
}

TEST_CASE("A morph refuses what it cannot do", "[morph]") {
  const auto a = line({20, 30}, {60, 30}, 9);
  const auto message = [&](const MorphOptions& options, int width = 320) {
    return test::message_of<core::InputError>([&] { graph::morph(a, a, width, 240, 25, options); });
  };
  CHECK(test::contains(message({.frames = 2}), "frames is 2; allowed is 3 to 10000"));
  CHECK(test::contains(message({}, 0), "0x240"));
  CHECK(message({}).empty());
}
