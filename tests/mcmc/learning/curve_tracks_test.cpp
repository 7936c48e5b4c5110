// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/curve_tracks.hpp"

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using graph::Point;
using mcmc::detail::CurveTrack;

namespace {

test::Scene one_stroke(double bend, int frames) {
  test::Scene scene;
  scene.frames = frames;
  scene.strokes = {{{60, 80}, 0.3, 150, bend}};
  // Wide swings, slow along the stroke: its normal turns little.
  scene.displacement = {1.5, -0.6, 0.5, 40};
  scene.gain = {0.8, 0, 0.1, 40};
  return scene;
}

std::size_t frame_of(const CurveTrack& track, std::size_t k) {
  return static_cast<std::size_t>(track.first) + k;
}

// The arc length at which the true curve lies nearest a point.
double arc_at(const test::Stroke& stroke, Point p) {
  double best = 0, nearest = 1e300;
  const auto look = [&](double from, double to, double step) {
    for (double s = from; s <= to; s += step)
      if (const double d = graph::distance(stroke.at(s), p); d < nearest) nearest = d, best = s;
  };
  look(-20, stroke.length + 20, 2);
  look(best - 2, best + 2, 0.05);
  return best;
}

}  // namespace

TEST_CASE("A lineage's travel is the curve's true displacement along its normal", "[lineages]") {
  for (const double bend : {0.0, 0.012, -0.02}) {
    const auto scene = one_stroke(bend, 60);
    const auto truth = test::make(scene, 5);
    const auto& stroke = scene.strokes[0];
    const auto all = mcmc::detail::track_curves(truth.motion);
    REQUIRE(all.size() >= 20);
    std::size_t compared = 0;
    double squares = 0;
    for (const auto& track : all) {
      const double s0 = arc_at(stroke, track.samples[0].position);
      const double sense =
          graph::dot(track.samples[0].normal, stroke.normal(s0)) < 0 ? -1 : 1;  // of the track's normals
      for (std::size_t k = 0; k < track.samples.size(); ++k) {
        const auto& sample = track.samples[k];
        const int t = static_cast<int>(frame_of(track, k));
        const double s = arc_at(stroke, sample.position);
        // On the curve: between patches 5 px apart it is a parabola through both with the turn of their
        // directions, off by some hundredths of a px.
        const double off = graph::dot(sample.position - stroke.at(s), stroke.normal(s));
        CHECK_THAT(off, Catch::Matchers::WithinAbs(truth.displacement[0].at(s, t), 0.05));
        // Compares the travel with the displacement at the track's place. Each of up to 60 steps goes along a
        // normal that is turned by the slope of the swings. That lengthens it by half the slope's square, 0.1
        // %, and moves the place along the curve.
        const double moved = truth.displacement[0].at(s, t) - truth.displacement[0].at(s0, track.first);
        squares += std::pow(sense * sample.normal_displacement - moved, 2);
        CHECK_THAT(sense * sample.normal_displacement, Catch::Matchers::WithinAbs(moved, 0.5));
        CHECK_THAT(graph::norm(sample.normal), Catch::Matchers::WithinAbs(1, 1e-12));
        CHECK_THAT(sample.contrast,
                   Catch::Matchers::WithinAbs(std::log(stroke.contrast) + truth.gain[0].at(s, t), 0.02));
        ++compared;
      }
    }
    REQUIRE(compared > 1000);
    // The displacements have an SD of 2 px.
    CHECK(std::sqrt(squares / double(compared)) < 0.15);
  }
}

TEST_CASE("A lineage lives as long as its curve", "[lineages]") {
  test::Scene scene = one_stroke(0.01, 80);
  scene.strokes.push_back({{60, 180}, 0, 150, 0, 40, 20, 50});
  const auto truth = test::make(scene, 6);
  const auto all = mcmc::detail::track_curves(truth.motion);
  std::array<int, 2> whole{};
  for (const auto& track : all) {
    const auto where = truth.where[static_cast<std::size_t>(track.first)][track.samples[0].vertex];
    const auto& stroke = scene.strokes[where.stroke];
    CHECK(track.first >= stroke.born);
    CHECK(track.last() < std::min(stroke.dies, scene.frames));
    if (track.first == stroke.born && track.last() == std::min(stroke.dies, scene.frames) - 1)
      ++whole[where.stroke];
    // Tracks inside the curve do not end early. The margin of 20 px covers the resampling and the motion
    // along the curve.
    if (where.s > 20 && where.s < stroke.length - 20 && track.first == stroke.born)
      CHECK(track.last() >= stroke.born + 20);
  }
  // A curve of 150 px has a place every 5 px.
  CHECK(whole[0] >= 20);
  CHECK(whole[1] >= 20);
}

TEST_CASE("Every place of a curve has a lineage and no two are closer than 2 px", "[lineages]") {
  test::Scene scene = one_stroke(0.015, 100);
  scene.strokes.push_back({{180, 190}, -0.2, 120, 0});  // far from the first
  const auto truth = test::make(scene, 7);
  const auto all = mcmc::detail::track_curves(truth.motion);
  std::vector<std::vector<Point>> places(100);
  int before_first = 0;
  for (const auto& track : all) {
    CHECK(track.first >= before_first);
    before_first = track.first;
    CHECK(track.samples[0].normal_displacement == 0);
    for (std::size_t k = 0; k < track.samples.size(); ++k)
      places[frame_of(track, k)].push_back(track.samples[k].position);
  }
  for (std::size_t t = 0; t < places.size(); ++t) {
    double closest = 1e9;
    for (std::size_t i = 0; i < places[t].size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        closest = std::min(closest, graph::distance(places[t][i], places[t][j]));
    CHECK(closest >= 2);
    const auto& graph = truth.motion.sketch.frames[t];
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      if (graph.degree(v) != 2) continue;
      double nearest = 1e9;
      for (const Point p : places[t])
        nearest = std::min(nearest, graph::distance(p, graph.patch(v).position));
      // A patch with none within 3 px begins one, another may lie between it and the one that it would begin.
      CHECK(nearest < 3);
    }
  }
}

TEST_CASE("Where a ring shrinks its lineages come together, and older ones stay", "[lineages]") {
  const auto ring = [](double radius) {
    test::Frame frame;
    std::vector<Point> points;
    for (int k = 0; k < 20; ++k) {
      const double angle = 2 * std::numbers::pi * k / 20;
      points.push_back(Point{100, 100} + Point{std::cos(angle), std::sin(angle)} * radius);
    }
    const auto first = frame.line(points);
    for (auto& v : frame.vertices)
      v.patch.theta = 2 * std::numbers::pi * v.id.value / 20 + std::numbers::pi / 2;
    frame.edge(first, first + 19);
    return frame.graph();
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t v = 0; v < 20; ++v) links.emplace_back(v, v);
  const auto all = mcmc::detail::track_curves(test::motion({ring(19), ring(10), ring(5)}, {links, links}));
  std::vector<std::vector<Point>> places(3);
  for (const auto& track : all)
    for (std::size_t k = 0; k < track.samples.size(); ++k)
      places[frame_of(track, k)].push_back(track.samples[k].position);
  CHECK(places[0].size() == 20);  // 6 px apart
  CHECK(places[1].size() == 20);  // 3 px
  CHECK(places[2].size() < 20);   // 1.6 px
  CHECK(places[2].size() >= 10);
  for (const auto& there : places)
    for (std::size_t i = 0; i < there.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) CHECK(graph::distance(there[i], there[j]) >= 2);
  for (const auto& track : all) CHECK(track.first == 0);
}

TEST_CASE("Without links there are only lineages of one frame", "[lineages]") {
  auto truth = test::make(one_stroke(0, 5), 3);
  for (auto& links : truth.motion.links) links.clear();
  const auto all = mcmc::detail::track_curves(truth.motion);
  std::size_t inner = 0;
  for (const auto& graph : truth.motion.sketch.frames)
    for (std::uint32_t v = 0; v < graph.size(); ++v) inner += graph.degree(v) == 2;
  CHECK(all.size() == inner);
  for (const auto& track : all) CHECK(track.samples.size() == 1);
  CHECK(mcmc::detail::track_curves({}).empty());
}

TEST_CASE("Neighbours lie side by side on one curve and know which way their normals point", "[lineages]") {
  test::Scene scene = one_stroke(0.01, 40);
  scene.strokes.push_back({{60, 90}, 0.3, 150, 0.01});  // 10 px beside the first
  const auto truth = test::make(scene, 8);
  const auto all = mcmc::detail::track_curves(truth.motion);
  const auto sides = mcmc::detail::find_track_neighbours(truth.motion, all);
  REQUIRE(sides.frames.size() == 40);
  std::size_t pairs = 0, returned = 0;
  for (std::size_t t = 0; t < sides.frames.size(); ++t) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> there;
    std::map<std::uint32_t, int> count;
    for (const auto& [a, b, sense] : sides.frames[t]) {
      there.emplace(a, b);
      ++count[a];
    }
    for (const auto& [a, b, sense] : sides.frames[t]) {
      const auto& one = all[a].samples[t - static_cast<std::size_t>(all[a].first)];
      const auto& other = all[b].samples[t - static_cast<std::size_t>(all[b].first)];
      CHECK(truth.where[t][one.vertex].stroke == truth.where[t][other.vertex].stroke);
      const Point apart = other.position - one.position;
      CHECK(graph::norm(apart) < 12);
      CHECK(graph::norm(apart) >= 2);
      // Along the curve rather than across.
      CHECK(std::abs(graph::dot(apart, one.normal)) < 0.5 * graph::norm(apart));
      CHECK(sense == (graph::dot(one.normal, other.normal) < 0 ? -1 : 1));
      ++pairs;
      returned += there.contains({b, a});
    }
    // One ahead and one behind; at the ends only one.
    for (const auto& [track, n] : count) CHECK(n <= 2);
    CHECK(there.size() == sides.frames[t].size());
  }
  REQUIRE(pairs > 40 * 2 * 20);
  // Each is the other's nearest, but where a third lies on the far side of a patch: seldom.
  CHECK(double(returned) > 0.9 * double(pairs));
}

TEST_CASE("Normals keep their sense though patches turn round", "[lineages]") {
  auto truth = test::make(one_stroke(0, 20), 9);
  // Every second frame's patches run the other way: the same curve.
  auto& frames = truth.motion.sketch.frames;
  for (std::size_t t = 1; t < frames.size(); t += 2) {
    std::vector<graph::Vertex> vertices(frames[t].vertices().begin(), frames[t].vertices().end());
    for (auto& v : vertices)
      v.patch.theta = std::remainder(v.patch.theta + std::numbers::pi, 2 * std::numbers::pi);
    frames[t] = {std::move(vertices), {frames[t].edges().begin(), frames[t].edges().end()}};
  }
  const auto turned = mcmc::detail::track_curves(truth.motion);
  const auto plain = mcmc::detail::track_curves(test::make(one_stroke(0, 20), 9).motion);
  REQUIRE(turned.size() == plain.size());
  for (std::size_t i = 0; i < turned.size(); ++i) {
    REQUIRE(turned[i].samples.size() == plain[i].samples.size());
    const double sense = graph::dot(turned[i].samples[0].normal, plain[i].samples[0].normal);
    for (std::size_t k = 0; k < turned[i].samples.size(); ++k) {
      CHECK_THAT(graph::dot(turned[i].samples[k].normal, plain[i].samples[k].normal),
                 Catch::Matchers::WithinAbs(sense, 1e-6));
      CHECK_THAT(turned[i].samples[k].normal_displacement * sense,
                 Catch::Matchers::WithinAbs(plain[i].samples[k].normal_displacement, 1e-6));
    }
  }
}

TEST_CASE("Patches take what they are told and those that are told nothing their neighbours'", "[lineages]") {
  test::Frame frame;
  frame.line(test::segment({0, 50}, {45, 50}, 10));
  frame.line(test::segment({0, 90}, {20, 90}, 5));
  const auto graph = frame.graph();
  SECTION("the same for all stays, with every patch of the stroke told and only some") {
    for (const bool all : {true, false}) {
      std::vector<mcmc::detail::TrackValue> told;
      for (std::uint32_t v = 0; v < 10; ++v)
        if (all || v == 4 || v == 6) told.push_back({v, {2, -1}});
      const auto values = mcmc::detail::smooth_over_patches(graph, told);
      REQUIRE(values.size() == graph.size());
      for (std::uint32_t v = all ? 0 : 2; v < (all ? 10 : 9); ++v) {
        CHECK_THAT(values[v].x, Catch::Matchers::WithinAbs(2, 1e-12));
        CHECK_THAT(values[v].y, Catch::Matchers::WithinAbs(-1, 1e-12));
      }
      // Nothing passes over to another stroke.
      for (std::uint32_t v = 10; v < 15; ++v) CHECK(values[v] == Point{});
    }
  }
  SECTION("of several told the mean") {
    std::vector<mcmc::detail::TrackValue> told;
    for (std::uint32_t v = 10; v < 15; ++v) told.insert(told.end(), {{v, {1, 0}}, {v, {2, 3}}, {v, {6, 0}}});
    const auto values = mcmc::detail::smooth_over_patches(graph, told);
    for (std::uint32_t v = 10; v < 15; ++v) {
      CHECK_THAT(values[v].x, Catch::Matchers::WithinAbs(3, 1e-12));
      CHECK_THAT(values[v].y, Catch::Matchers::WithinAbs(1, 1e-12));
    }
  }
  SECTION("a linear course stays linear away from the ends") {
    std::vector<mcmc::detail::TrackValue> told;
    for (std::uint32_t v = 0; v < 10; ++v) told.push_back({v, {0.5 * v, 1 - 0.1 * v}});
    const auto values = mcmc::detail::smooth_over_patches(graph, told);
    for (std::uint32_t v = 3; v < 7; ++v) {
      CHECK_THAT(values[v].x, Catch::Matchers::WithinAbs(0.5 * v, 1e-12));
      CHECK_THAT(values[v].y, Catch::Matchers::WithinAbs(1 - 0.1 * v, 1e-12));
    }
  }
  SECTION("nothing told is zero") {
    for (const Point p : mcmc::detail::smooth_over_patches(graph, {})) CHECK(p == Point{});
  }
}
