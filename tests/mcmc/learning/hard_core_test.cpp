// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/hard_core.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rng.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

graph::MotionGraph clip_of(std::vector<graph::AttributeGraph> frames) {
  graph::MotionGraph motion;
  motion.sketch.width = 640, motion.sketch.height = 480;
  motion.links.resize(frames.size());
  motion.sketch.frames = std::move(frames);
  return motion;
}

/// Ridges `apart` px from each other or more, at random; each with a valley `beside` px below it and a step
/// as far above.
graph::AttributeGraph folds(double apart, double beside, core::Rng& rng) {
  test::Frame frame;
  for (double y = 10; y < 470; y += apart + rng.uniform(0, 20)) {
    frame.line(test::segment({20, y}, {620, y}, 121));
    frame.line(test::segment({20, y + beside}, {620, y + beside}, 121), -40);
    const auto first = frame.vertices.size();
    frame.line(test::segment({20, y - beside}, {620, y - beside}, 121));
    for (auto v = first; v < frame.vertices.size(); ++v) frame.vertices[v].patch.width = 0;
  }
  return frame.graph();
}

double nearest(const graph::AttributeGraph& graph) {
  const auto parts = graph::components(graph);
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t v = 0; v < graph.size(); ++v)
    for (std::uint32_t w = 0; w < v; ++w)
      if (parts.of_vertex[v] != parts.of_vertex[w])
        least = std::min(least, graph::distance(graph.patch(v).position, graph.patch(w).position));
  return least;
}

}  // namespace

TEST_CASE("How far strokes keep apart is read off, each kind of pair by itself", "[exclusion]") {
  core::Rng rng(3);
  std::vector<graph::AttributeGraph> frames;
  for (int t = 0; t < 20; ++t) frames.push_back(folds(24, 4, rng));
  const auto motion = clip_of(std::move(frames));
  const auto found = mcmc::estimate_hard_core(motion);
  CHECK(found.alike == 12);  // as far as it looks
  CHECK_THAT(found.lines, WithinAbs(4, 0.51));
  CHECK_THAT(found.mixed, WithinAbs(4, 0.51));
}

TEST_CASE("Strokes that lie anywhere keep no distance", "[exclusion]") {
  core::Rng rng(4);
  std::vector<graph::AttributeGraph> frames;
  for (int t = 0; t < 20; ++t) {
    test::Frame frame;
    for (int k = 0; k < 60; ++k) {
      const graph::Point a{rng.uniform(20, 560), rng.uniform(20, 460)};
      const double theta = rng.uniform(0, 6.28);
      frame.line(test::segment(a, a + graph::Point{std::cos(theta), std::sin(theta)} * 50, 11));
    }
    frames.push_back(frame.graph());
  }
  const auto motion = clip_of(std::move(frames));
  const auto found = mcmc::estimate_hard_core(motion);
  CHECK(found.alike <= 1);
  CHECK(found.lines == 0);  // there are no valleys
  CHECK(found.mixed == 0);
}

TEST_CASE("What comes too near makes way, and what goes on beyond an end does not", "[exclusion]") {
  auto model = test::empty_model();
  test::Frame frame;
  frame.line(test::segment({40, 100}, {140, 100}, 21));
  SECTION("a line beside it") {
    frame.line(test::segment({40, 104}, {140, 104}, 21));
    model.first = frame.graph();
    SECTION("of the same kind") {
      model.hard_core.alike = 8;
      const auto motion = mcmc::synthesize(model, 12, 1);
      CHECK_THAT(nearest(motion.sketch.frames.back()), WithinAbs(8, 0.1));
    }
    SECTION("of another kind") {
      model.hard_core.lines = 8;
      const auto motion = mcmc::synthesize(model, 12, 1);
      CHECK(nearest(motion.sketch.frames.back()) == 4);
    }
  }
  SECTION("a line behind its end") {
    frame.line(test::segment({144, 100}, {240, 100}, 20));
    model.first = frame.graph();
    model.hard_core.alike = 8;
    const auto motion = mcmc::synthesize(model, 12, 1);
    CHECK(nearest(motion.sketch.frames.back()) == 4);
  }
}

TEST_CASE("Strokes are born and sway as far apart as they are to be", "[exclusion]") {
  auto model = test::coming_and_going(9, 8, 0.25, 0.03);
  model.displacement = {0.97, 0, 0, 0.8, 20, 0};
  const auto near = [&] {
    const auto motion = mcmc::synthesize(model, 200, 2);
    int all = 0, too_near = 0;
    for (std::size_t t = 100; t < 200; t += 10) {
      const auto& graph = motion.sketch.frames[t];
      const auto parts = graph::components(graph);
      for (std::uint32_t v = 0; v < graph.size(); ++v, ++all)
        for (std::uint32_t w = 0; w < graph.size(); ++w)
          if (parts.of_vertex[v] != parts.of_vertex[w] &&
              graph::distance(graph.patch(v).position, graph.patch(w).position) < 6) {
            ++too_near;
            break;
          }
    }
    return double(too_near) / all;
  };
  const double without = near();
  model.hard_core.alike = 8;
  const double with = near();
  CAPTURE(without, with);
  CHECK(without > 0.015);
  CHECK(with < 0.2 * without);
}
