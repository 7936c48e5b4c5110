// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_identity.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <set>

#include "core/error.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "graph/events/events.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/touching_curves.hpp"

using namespace emberfold;
using test::moving_line;
using test::TouchingCurves;

namespace {

constexpr double kPi = std::numbers::pi;

/// How many curves keep the name that they have in frame 0, over all frames, and that no other has.
struct Kept {
  int kept = 0, all = 0;
  void add(const TouchingCurves& scene, std::uint32_t curves) {
    const auto motion = graph::identify_curves(scene.motion).motion;
    for (std::size_t t = 1; t < scene.owner.size(); ++t) {
      for (std::uint32_t k = 0; k < curves; ++k) {
        const auto name = test::curve_of(motion, scene, t, k);
        bool own = name != 0 && name == test::curve_of(motion, scene, 0, k);
        for (std::uint32_t other = 0; other < curves; ++other)
          own = own && (other == k || test::curve_of(motion, scene, t, other) != name);
        kept += own ? 1 : 0, ++all;
      }
    }
  }
  [[nodiscard]] double share() const { return static_cast<double>(kept) / all; }
};

std::set<std::uint32_t> curves_of(const graph::AttributeGraph& graph) {
  std::set<std::uint32_t> result;
  for (const auto& v : graph.vertices())
    if (graph.degree(static_cast<std::size_t>(&v - graph.vertices().data())) > 0)
      result.insert(v.curve.value);
  return result;
}

}  // namespace

TEST_CASE("Curves that cross keep their names in 98 % of frames", "[graph][curves]") {
  Kept kept;
  core::Rng rng(1);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::vector<test::MovingCurve> curves;
    const auto count = 2 + rng.below(3);
    for (std::uint32_t k = 0; k < count; ++k) {
      // spread over half a turn, so that no two lie along each other; they pass the middle at different times
      const double angle = kPi * (k + rng.uniform(-0.2, 0.2)) / count, way = rng.uniform(-30, 30);
      const double bend = rng.uniform(-0.002, 0.002), length = rng.uniform(90, 140),
                   aside = rng.uniform(-20, 20);
      const graph::Point along{std::cos(angle), std::sin(angle)}, normal{-along.y, along.x};
      curves.push_back(moving_line(graph::Point{160, 120} + normal * way + along * aside, normal * (-way / 8),
                                   angle, length, 40, 0, bend));
    }
    kept.add(TouchingCurves(curves, 17, seed), count);
  }
  INFO(kept.kept << " of " << kept.all);
  CHECK(kept.share() >= 0.98);
}

TEST_CASE("A curve whose tip touches the side of another and leaves it keeps its name", "[graph][curves]") {
  Kept kept;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto there_and_back = [](int t) { return graph::Point{0, std::abs(t - 8) * 2.0}; };
    const auto upright = moving_line({160, 120 - 40}, {}, kPi / 2, 80);
    test::MovingCurve tip{[=](int t) {
      auto points = upright.points(0);
      for (auto& p : points) p = p - there_and_back(t);
      return points;
    }};
    const TouchingCurves scene({moving_line({160, 120}, {}, 0.1, 120), tip}, 17, seed);
    kept.add(scene, 2);
    // for the strokes they are one from here to there, for the curves nothing happens
    const auto events = graph::stroke_events(scene.motion);
    CHECK(events.size() >= 2);
    auto named = graph::identify_curves(scene.motion).motion;
    CHECK(graph::stroke_events(graph::curves_as_strokes(named)).empty());
  }
  CHECK(kept.share() == 1);
}

TEST_CASE("Curves that cross at a small angle keep their names", "[graph][curves]") {
  Kept kept;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double angle = 0.35 + 0.01 * static_cast<double>(seed);
    const std::vector<test::MovingCurve> curves{
        moving_line({160, 105}, {0, 1.5}, 0.1, 130, 40),
        moving_line({160, 135}, {0, -1.5}, 0.1 + angle, 130, 42),
    };
    kept.add(TouchingCurves(curves, 21, seed), 2);
  }
  INFO(kept.kept << " of " << kept.all);
  CHECK(kept.share() >= 0.98);
}

TEST_CASE("Tips that meet in line for some frames leave each other under their old names",
          "[graph][curves]") {
  for (const int met : {2, 6, 10}) {
    Kept kept;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto along = [=](double middle, double sign) {
        return test::MovingCurve{[=](int t) {
          const double apart = 2 + std::max(0.0, 1.5 * (std::abs(t - 12) - met / 2.0));
          std::vector<graph::Point> points;
          for (double s = 0; s <= 70; s += 0.5) points.push_back({middle + sign * (apart + s), 120});
          return points;
        }};
      };
      kept.add(TouchingCurves({along(160, -1), along(160, 1)}, 25, seed), 2);
    }
    INFO(met << ": " << kept.kept << " of " << kept.all);
    CHECK(kept.share() >= 0.98);
  }
}

TEST_CASE("Curves of different contrast that touch all the time are two", "[graph][curves]") {
  for (const double angle : {0.5, 0.9}) {
    Kept kept;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      // curves elsewhere tell how contrast varies from one curve to another
      std::vector<test::MovingCurve> curves{
          moving_line({110, 120}, {0.3, 0}, 0, 80, 40),
          moving_line({152 + 40 * std::cos(angle), 120 + 40 * std::sin(angle)}, {0.3, 0}, angle, 80, 55)};
      for (int k = 0; k < 6; ++k) curves.push_back(moving_line({160, 20.0 + 12 * k}, {}, 0, 90, 30 + 6 * k));
      kept.add(TouchingCurves(curves, 12, seed), static_cast<std::uint32_t>(curves.size()));
    }
    CHECK(kept.share() >= 0.98);
  }
}

TEST_CASE("A curve with a corner is one", "[graph][curves]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const test::MovingCurve corner{[](int t) {
      std::vector<graph::Point> points;
      for (double s = 60; s > 0; s -= 0.5) points.push_back({100 + s, 100 + 0.5 * t});
      for (double s = 0; s <= 60; s += 0.5) points.push_back({100 + 0.4 * s, 100 + s + 0.5 * t});
      return points;
    }};
    const auto motion = graph::identify_curves(TouchingCurves({corner}, 10, seed).motion).motion;
    for (const auto& frame : motion.sketch.frames) CHECK(curves_of(frame) == std::set<std::uint32_t>{1});
  }
}

TEST_CASE("At a crossing the pairs that go straight on are likely, the others are not", "[graph][curves]") {
  const TouchingCurves scene(
      {moving_line({160, 120}, {0.5, 0}, 0.2, 120), moving_line({160, 120}, {0.5, 0}, 1.4, 120)}, 8, 3);
  const auto grouping = graph::identify_curves(scene.motion);
  int straight = 0, others = 0;
  for (const auto& joint : grouping.joints) {
    CHECK((joint.probability >= 0 && joint.probability <= 1));
    if (!joint.at_junction) continue;
    CHECK(graph::distance(joint.position, {160 + 0.5 * joint.frame, 120}) < 12);
    CHECK((joint.probability > 0.9) == (joint.a == joint.b));
    CHECK((joint.probability < 0.1) == (joint.a != joint.b));
    ++(joint.a == joint.b ? straight : others);
  }
  CHECK(straight == 2 * 8);
  CHECK(others == 4 * 8);
}

TEST_CASE("Curves leave graphs, links and strokes as they are, and are numbered in order",
          "[graph][curves]") {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 6, 10));
    const auto named = graph::identify_curves(motion).motion;
    std::uint32_t last = 0;
    for (std::size_t t = 0; t < named.sketch.frames.size(); ++t) {
      const auto& frame = named.sketch.frames[t];
      for (const auto& v : frame.vertices()) {
        CHECK((v.curve.value >= 1 && v.curve.value <= last + 1));
        last = std::max(last, v.curve.value);
      }
      CHECK(frame.with_curves(std::vector<graph::CurveId>(frame.size())) == motion.sketch.frames[t]);
    }
    CHECK(named.links == motion.links);
    CHECK(graph::identify_curves(motion).motion == named);
    CHECK_NOTHROW(graph::validate(graph::curves_as_strokes(named)));
  }
  CHECK(graph::identify_curves({}).motion.sketch.frames.empty());
  CHECK_THROWS_AS(test::random_motion(3, 2, 4).sketch.frames[0].with_curves(std::vector<graph::CurveId>(99)),
                  core::InputError);
}
