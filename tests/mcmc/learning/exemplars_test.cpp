// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/exemplars.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "graph/events/events.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

graph::Event birth_or_death(graph::EventType type, int frame, std::uint32_t stroke) {
  graph::Event event;
  event.type = type, event.frame = frame;
  (type == graph::EventType::birth ? event.after : event.before) = {graph::SubgraphId{stroke}};
  return event;
}

/// Births and deaths of strokes that live for so many frames.
std::vector<graph::Event> lives_of(const std::vector<int>& frames) {
  std::vector<graph::Event> events;
  for (std::uint32_t k = 0; k < frames.size(); ++k) {
    events.push_back(birth_or_death(graph::EventType::birth, 5, k));
    events.push_back(birth_or_death(graph::EventType::death, 5 + frames[k], k));
  }
  return events;
}

std::vector<std::vector<double>> no_deviation(const graph::MotionGraph& motion) {
  std::vector<std::vector<double>> all;
  for (const auto& frame : motion.sketch.frames) all.emplace_back(frame.size());
  return all;
}

}  // namespace

TEST_CASE("The refractory period is the lifetime that nine in ten strokes reach, 8 frames at most",
          "[exemplars]") {
  std::vector<int> frames;
  for (int k = 20; k > 0; --k) frames.push_back(k);
  CHECK(mcmc::estimate_refractory_period(lives_of(frames)) == 3);
  for (int& life : frames) life += 30;
  CHECK(mcmc::estimate_refractory_period(lives_of(frames)) == 8);
  CHECK(mcmc::estimate_refractory_period(lives_of({2, 2, 2, 2})) == 0);
  CHECK(mcmc::estimate_refractory_period(lives_of({2, 3, 4, 5, 6})) == 2);
  // Strokes that were there from the first frame on, or to the last, do not count.
  auto events = lives_of({7, 7, 7, 7, 7});
  for (std::uint32_t k = 10; k < 20; ++k)
    events.push_back(birth_or_death(k % 2 == 0 ? graph::EventType::birth : graph::EventType::death, 6, k));
  CHECK(mcmc::estimate_refractory_period(events) == 7);
}

TEST_CASE("A born stroke's size is the one half way through its life", "[exemplars]") {
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < 12; ++t) {
    Frame frame;
    frame.line(segment({50, 50}, {60, 50}, 3));
    const int patches = t < 2 ? 0 : t < 5 ? 4 : t < 10 ? 20 : 40;  // from frame 2 on, half way in frame 7
    if (patches > 0) frame.line(segment({50, 150}, {50.0 + 5 * patches, 150}, patches));
    frames.push_back(frame.graph());
    if (t == 0) continue;
    auto& gap = links.emplace_back();
    const auto both = std::min(frames[frames.size() - 2].size(), frames.back().size());
    for (std::uint32_t v = 0; v < both; ++v) gap.emplace_back(v, v);
  }
  const auto motion = graph::identify(test::motion(frames, links));
  const auto events = graph::stroke_events(motion);
  const auto births = mcmc::count_births_by_size(motion, events);
  for (std::size_t k = 0; k < births.size(); ++k) CHECK(births[k] == (k == mcmc::size_class(20) ? 1 : 0));
}

TEST_CASE("Exemplars of each size are in proportion to the strokes of all frames, evenly over the clip",
          "[exemplars]") {
  std::vector<graph::AttributeGraph> frames;
  for (int t = 0; t < 100; ++t) {
    Frame frame;
    for (int k = 0; k < 3; ++k) frame.line(segment({40.0 + 60 * k, 50}, {50.0 + 60 * k, 50}, 3));
    frame.line(segment({40, 100.0 + t}, {80, 100.0 + t}, 9));
    frames.push_back(frame.graph());
  }
  const auto motion =
      test::motion(frames, std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>(99));
  const auto found = mcmc::sample_exemplars(motion, no_deviation(motion), 80);
  CHECK(std::ranges::count_if(found, [](const auto& one) { return one.graph.size() == 3; }) == 60);
  std::vector<double> heights;
  for (const auto& one : found) {
    if (one.graph.size() == 3) {
      // From the middle patch to the nearest of a neighbour: 60 px less a stroke's length.
      CHECK(one.place.y == 50);
      CHECK_THAT(one.clearance, WithinAbs(50, 1e-9));
      CHECK(one.graph.edges().size() == 2);
      CHECK(one.graph.patch(0).position == graph::Point{-5, 0});
    } else {
      heights.push_back(one.place.y);
      CHECK(one.place.x == 60);
      CHECK(one.graph.patch(8).position == graph::Point{20, 0});
    }
  }
  REQUIRE(heights.size() == 20);
  for (std::size_t k = 0; k < heights.size(); ++k) CHECK(heights[k] == 100.0 + 5 * static_cast<double>(k));
  // Few of a size are taken all the same, a dozen at least.
  const auto few = mcmc::sample_exemplars(motion, no_deviation(motion), 8);
  CHECK(few.size() == 24);
}

TEST_CASE("An exemplar has the mean contrast of its tracks and the shape that was seen", "[exemplars]") {
  Frame frame;
  frame.line(segment({40, 50}, {60, 50}, 3));
  const auto graph = frame.graph();
  const std::vector<double> deviation{std::log(2), 0, -std::log(4)};
  const auto usual = mcmc::with_usual_contrast(graph, deviation);
  for (std::uint32_t v = 0; v < 3; ++v) CHECK(usual.patch(v).position == graph.patch(v).position);
  CHECK_THAT(usual.patch(0).contrast, WithinAbs(20, 1e-9));
  CHECK_THAT(usual.patch(2).contrast, WithinAbs(160, 1e-9));
  CHECK(usual.edges().size() == 2);
}
