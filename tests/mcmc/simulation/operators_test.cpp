// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/operators.hpp"

#include <map>
#include <numbers>
#include <set>

#include "graph/events/events.hpp"
#include "mcmc/simulation/simulation_step.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using graph::EventType;
using graph::Point;

namespace {

using Tally = std::array<int, 6>;

std::size_t number(EventType type) {
  return static_cast<std::size_t>(type);
}

// A clip and the operators of each of its frames.
struct Clip {
  graph::MotionGraph motion;
  std::vector<Tally> tallies;
};
Clip clip(const mcmc::MotionModel& model, int frames, std::uint64_t seed = 1) {
  Clip result{mcmc::synthesize(model, frames, seed), {}};
  mcmc::Synthesis synthesis(model, seed);
  for (int t = 0; t < frames; ++t) {
    (void)synthesis.next();
    result.tallies.push_back(synthesis.operators());
  }
  return result;
}

// Events of each type in each frame.
std::vector<Tally> events_of(const graph::MotionGraph& motion) {
  std::vector<Tally> result(motion.sketch.frames.size());
  for (const auto& event : graph::stroke_events(motion))
    ++result[static_cast<std::size_t>(event.frame)][number(event.type)];
  return result;
}

// The events are those of the operators and no others. Separations and deaths are seen a frame later, when
// the faded patches (none, here) are gone.
void check_agreement(const Clip& clip, EventType type, bool later, int least) {
  const auto events = events_of(clip.motion);
  int all = 0;
  for (std::size_t t = 1; t < events.size(); ++t) {
    Tally expected{};
    const auto& said = clip.tallies[later ? t - 1 : t];
    expected[number(type)] = said[number(type)];
    CAPTURE(t);
    CHECK(events[t] == expected);
    CHECK(said == expected);
    all += events[t][number(type)];
  }
  CHECK(all >= least);
}

std::size_t vertices_by_stroke(const graph::AttributeGraph& graph) {
  return graph::components(graph).count;
}

mcmc::MotionModel showing(const test::Frame& frame) {
  auto model = test::empty_model();
  model.first = frame.graph();
  model.exemplars.push_back({test::straight(2), {160, 120}, 10});  // of a stroke smaller than all others
  return model;
}

// Copies of `add`'s strokes at twelve places of the frame.
template <class Add>
test::Frame tiled(Add add) {
  test::Frame frame;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 3; ++x) add(frame, Point{10 + 105.0 * x, 12 + 60.0 * y});
  return frame;
}

void straight_stroke(test::Frame& frame, Point at) {
  frame.line(test::segment(at, at + Point{90, 0}, 19));
}

}  // namespace

TEST_CASE("Without rates nothing ever happens", "[operators]") {
  auto model = showing(tiled(straight_stroke));
  SECTION("with exemplars") {}
  SECTION("with no exemplars") {
    model.exemplars.clear();
  }
  const auto found = clip(model, 20);
  for (const auto& tally : found.tallies) CHECK(tally == Tally{});
  CHECK(graph::stroke_events(found.motion).empty());
  for (const auto& graph : found.motion.sketch.frames) {
    REQUIRE(graph.size() == model.first.size());
    CHECK(graph.edges().size() == model.first.edges().size());
    for (std::size_t v = 0; v < graph.size(); ++v)
      CHECK(graph.patch(v).position == model.first.patch(v).position);
  }
}

TEST_CASE("At a rate of one every stroke of that size dies", "[operators]") {
  test::Frame frame;
  frame.line(test::segment({20, 20}, {60, 20}, 9));
  frame.line(test::segment({20, 60}, {60, 60}, 9));
  frame.line(test::segment({20, 100}, {40, 100}, 5));
  auto model = showing(frame);
  model.rates.death_by_size[2] = 1;  // 9 to 16 patches
  const auto found = clip(model, 4);
  CHECK(found.tallies[1] == Tally{0, 2, 0, 0, 0, 0});
  CHECK(found.tallies[2] == Tally{});
  CHECK(found.motion.sketch.frames[1].size() == 23);
  CHECK(found.motion.sketch.frames[2].size() == 5);
  CHECK(found.motion.sketch.frames[3].size() == 5);
  check_agreement(found, EventType::death, true, 2);
}

TEST_CASE("A stroke smaller than any that was seen goes", "[operators]") {
  test::Frame frame;
  frame.line(test::segment({20, 20}, {60, 20}, 9));
  frame.line(test::segment({20, 60}, {30, 60}, 3));
  auto model = showing(frame);
  model.exemplars[0].graph = test::straight(4);
  CHECK(clip(model, 3).motion.sketch.frames[2].size() == 9);
}

TEST_CASE("The death map says where strokes die", "[operators]") {
  auto model = showing(tiled(straight_stroke));
  model.rates.death_by_size[3] = 1;
  for (std::size_t c = 0; c < model.rates.death.values.size(); ++c)
    model.rates.death.values[c] = c % std::size_t(model.rates.death.columns) < 7 ? 1 : 0;  // x below 112
  const auto found = clip(model, 3);
  CHECK(found.tallies[1][number(EventType::death)] == 4);
  for (const auto& vertex : found.motion.sketch.frames[2].vertices()) CHECK(vertex.patch.position.x > 112);
}

TEST_CASE("The birth map says where strokes are born", "[operators]") {
  auto model = test::empty_model();
  for (int k = 0; k < 10; ++k)  // as many exemplars on the left as on the right
    model.exemplars.push_back({test::straight(5), {k < 5 ? 60.0 : 260.0, 40.0 + 40 * (k % 5)}, 20});
  model.rates.birth_by_size[mcmc::size_class(5)] = 1;
  for (std::size_t c = 0; c < model.rates.birth.values.size(); ++c)  // all births at x below 160
    model.rates.birth.values[c] = c % std::size_t(model.rates.birth.columns) < 10 ? 1.0 / (160 * 240) : 0;
  const auto found = clip(model, 40);
  int births = 0;
  for (const auto& event : graph::stroke_events(found.motion)) {
    CHECK(event.position.x < 160);
    ++births;
  }
  CHECK(births > 20);
}

TEST_CASE("Strokes go where the drift carries them", "[operators]") {
  auto model = showing(tiled(straight_stroke));
  for (double& value : model.drift_x.values) value = 0.75;
  for (double& value : model.drift_y.values) value = -0.5;
  const auto& frames = clip(model, 11).motion.sketch.frames;
  REQUIRE(frames[10].size() == model.first.size());
  for (std::size_t v = 0; v < frames[10].size(); ++v)
    CHECK(graph::distance(frames[10].patch(v).position, model.first.patch(v).position + Point{7.5, -5}) <
          1e-9);
}

TEST_CASE("At a rate of one a stroke splits once and leaves a gap of that width", "[operators]") {
  for (const double gap : {10.0, 15.0, 20.0, 30.0}) {
    test::Frame frame;
    frame.line(test::segment({20, 20}, {220, 20}, 41));
    auto model = showing(frame);
    model.rates.split = 1;
    model.rates.split_gap = gap;
    // A place in the middle, where both sides are long.
    for (double& value : model.rates.separation.values) value = 0;
    model.rates.separation.values[model.rates.separation.index({120, 20})] = 1;
    const auto found = clip(model, 3);
    CHECK(found.tallies[1] == Tally{0, 0, 1, 0, 0, 0});
    const auto& after = found.motion.sketch.frames[2];
    CHECK(vertices_by_stroke(after) == 2);
    std::vector<double> ends;
    for (std::size_t v = 0; v < after.size(); ++v)
      if (after.degree(v) == 1) ends.push_back(after.patch(v).position.x);
    std::ranges::sort(ends);
    REQUIRE(ends.size() == 4);
    CHECK_THAT(ends[2] - ends[1], Catch::Matchers::WithinAbs(gap, 1e-9));
    check_agreement(clip(model, 3), EventType::split, true, 1);
  }
}

TEST_CASE("At a rate of one ends in line merge and ends beside a line connect", "[operators]") {
  const bool in_line = GENERATE(true, false);
  test::Frame frame;
  frame.line(test::segment({20, 20}, {100, 20}, 17), 40);
  if (in_line)
    frame.line(test::segment({120, 20}, {200, 20}, 17), 60);
  else
    frame.line(test::segment({60, 40}, {60, 100}, 13), 60);
  auto model = showing(frame);
  (in_line ? model.rates.merge : model.rates.connect) = 1;
  const auto found = clip(model, 3);
  const auto type = in_line ? EventType::merge : EventType::connect;
  CHECK(found.tallies[1][number(type)] == 1);
  CHECK(vertices_by_stroke(found.motion.sketch.frames[0]) == 2);
  const auto& joined = found.motion.sketch.frames[1];
  CHECK(vertices_by_stroke(joined) == 1);
  // 20 px, a patch every 5 px: three, of contrasts between.
  REQUIRE(joined.size() == frame.vertices.size() + 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& patch = joined.patch(frame.vertices.size() + k);
    const double u = 0.25 * double(k + 1);
    CHECK(patch.contrast > 40);
    CHECK(patch.contrast < 60);
    CHECK(patch.type == graph::PatchType::ridge);
    if (in_line) {
      CHECK_THAT(graph::distance(patch.position, {100 + 20 * u, 20}), Catch::Matchers::WithinAbs(0, 1e-9));
      CHECK_THAT(patch.contrast, Catch::Matchers::WithinAbs(40 + 20 * u, 1e-9));
    } else {
      CHECK_THAT(patch.position.x, Catch::Matchers::WithinAbs(60, 1e-9));
      CHECK_THAT(std::abs(std::remainder(patch.theta, std::numbers::pi)),
                 Catch::Matchers::WithinAbs(std::numbers::pi / 2, 1e-9));
    }
  }
  check_agreement(found, type, false, 1);
  // Beyond their reach they do not.
  model.rates.reach = 19;
  CHECK(vertices_by_stroke(clip(model, 3).motion.sketch.frames[2]) == 2);
}

TEST_CASE("A bridge leaves as the stroke ends and sways as its ends do", "[operators]") {
  test::Frame frame;
  frame.line(test::segment({60, 20}, {60, 60}, 9));
  frame.line(
      test::segment({20, 72}, {200, 92}, 37));  // the nearest patch lies aside of where the other points
  auto model = showing(frame);
  model.rates.connect = 1;
  model.displacement = {0.9, 0, 0, 0.5, 20, 0};
  for (double& share : model.displacement_scale.values) share = 0.01;
  const auto joined = clip(model, 2).motion.sketch.frames[1];
  REQUIRE(vertices_by_stroke(joined) == 1);
  REQUIRE(joined.size() >= frame.vertices.size() + 2);
  // The bridge has no sharp turns. Between strokes that hardly move it hardly moves.
  for (auto v = static_cast<std::uint32_t>(frame.vertices.size()); v + 1 < joined.size(); ++v) {
    REQUIRE(joined.degree(v) == 2);
    const auto sides = joined.neighbours(v);
    const graph::Point in = joined.patch(v).position - joined.patch(sides[0]).position,
                       out = joined.patch(sides[1]).position - joined.patch(v).position;
    CHECK(std::abs(graph::dot(in, out)) > 0.85 * graph::norm(in) * graph::norm(out));
  }
  const auto later = clip(model, 40).motion.sketch.frames[39];
  for (auto v = static_cast<std::uint32_t>(frame.vertices.size()); v < joined.size(); ++v)
    CHECK(graph::distance(later.patch(v).position, joined.patch(v).position) < 0.3);
}

TEST_CASE("Events read off a synthesized clip are those that the operators carried out", "[operators]") {
  SECTION("births") {
    auto model = test::empty_model();
    model.exemplars = {{test::straight(7, 0.4), {80, 60}, 20}, {test::straight(11, 1.4), {230, 150}, 20}};
    model.rates.birth_by_size = {0, 0.5, 0.5, 0, 0, 0, 0};
    for (double& value : model.rates.birth.values) value = 1.5 / (320 * 240);
    const auto found = clip(model, 60);
    check_agreement(found, EventType::birth, false, 1);
    // Poisson of mean 1.5 a frame, in 59.
    double births = 0;
    for (const auto& tally : found.tallies) births += tally[0];
    CHECK_THAT(births, Catch::Matchers::WithinAbs(88.5, 4 * std::sqrt(88.5)));
    const auto& last = found.motion.sketch.frames.back();
    const auto parts = graph::components(last);
    CHECK(double(parts.count) == births);
    const double long_ones = (double(last.size()) - 7 * births) / 4;
    CHECK_THAT(long_ones, Catch::Matchers::WithinAbs(births / 2, 4 * std::sqrt(births) / 2));
    // Born about where they were seen, 4 px each way.
    for (const auto& event : graph::stroke_events(found.motion))
      CHECK(std::min(graph::distance(event.position, {80, 60}), graph::distance(event.position, {230, 150})) <
            30);
  }
  SECTION("deaths") {
    auto model = showing(tiled(straight_stroke));
    model.rates.death_by_size.fill(0.05);
    check_agreement(clip(model, 60), EventType::death, true, 8);
  }
  SECTION("splits") {
    auto model = showing(tiled(straight_stroke));
    model.rates.split = 0.01;
    check_agreement(clip(model, 80), EventType::split, true, 12);
  }
  SECTION("merges") {
    auto model = showing(tiled([](test::Frame& frame, Point at) {
      frame.line(test::segment(at, at + Point{35, 0}, 8));
      frame.line(test::segment(at + Point{50, 2}, at + Point{85, 2}, 8));
    }));
    model.rates.merge = 0.05;
    check_agreement(clip(model, 80), EventType::merge, false, 12);
  }
  SECTION("connects") {
    auto model = showing(tiled([](test::Frame& frame, Point at) {
      straight_stroke(frame, at);
      frame.line(test::segment(at + Point{45, 12}, at + Point{45, 37}, 6));
    }));
    model.rates.reach = 14;
    model.rates.connect = 0.05;
    check_agreement(clip(model, 80), EventType::connect, false, 8);
  }
  SECTION("disconnects") {
    auto model = showing(tiled([](test::Frame& frame, Point at) {
      const auto line = frame.line(test::segment(at, at + Point{90, 0}, 19));
      const auto bar = frame.line(test::segment(at + Point{45, 5}, at + Point{45, 35}, 7));
      frame.edge(line + 9, bar);
    }));
    model.rates.disconnect = 0.01;
    check_agreement(clip(model, 80), EventType::disconnect, true, 12);
  }
}

TEST_CASE("What is born fades in and what dies fades out", "[operators]") {
  auto model = test::empty_model();
  test::Frame frame;
  frame.line(test::segment({20, 20}, {60, 20}, 9));
  model.first = frame.graph();
  model.exemplars = {{test::straight(5), {200, 150}, 20}};
  model.appearing = {0.25, 0.5, 0.75, 1, 1, 1, 1, 1};
  model.vanishing = {0.2, 0.5, 0.8, 1, 1, 1, 1, 1};
  SECTION("in") {
    model.rates.birth_by_size[1] = 1;
    for (double& value : model.rates.birth.values) value = 0.5 / (320 * 240);
    mcmc::Synthesis synthesis(model, 3);
    std::map<std::uint32_t, int> ages;
    for (int t = 0; t < 40; ++t) {
      const auto graph = synthesis.next();
      for (const auto& vertex : graph.vertices()) {
        if (vertex.patch.position.x < 100) {
          CHECK(vertex.patch.contrast == 40);  // there from the beginning
          continue;
        }
        const int age = ages[vertex.id.value]++;
        CHECK_THAT(vertex.patch.contrast,
                   Catch::Matchers::WithinRel(40 * std::min(1.0, 0.25 * (age + 1)), 1e-12));
      }
    }
    CHECK(ages.size() >= 5);
  }
  SECTION("out") {
    model.rates.death_by_size[2] = 1;
    mcmc::Synthesis synthesis(model, 3);
    std::vector<double> contrasts;
    int deaths = 0;
    for (int t = 0; t < 10; ++t) {
      const auto graph = synthesis.next();
      deaths += synthesis.operators()[1];
      contrasts.push_back(graph.empty() ? 0 : graph.patch(4).contrast);
    }
    CHECK(deaths == 1);
    std::vector<double> fall;
    for (std::size_t t = 1; t < contrasts.size(); ++t) {
      CHECK(contrasts[t] <= contrasts[t - 1]);
      if (contrasts[t] < 40 && contrasts[t] > 0) fall.push_back(contrasts[t] / 40);
    }
    REQUIRE(fall.size() == 3);
    CHECK_THAT(fall[0], Catch::Matchers::WithinAbs(0.8, 1e-12));
    CHECK_THAT(fall[1], Catch::Matchers::WithinAbs(0.5, 1e-12));
    CHECK_THAT(fall[2], Catch::Matchers::WithinAbs(0.2, 1e-12));
    CHECK(contrasts.back() == 0);
  }
}

TEST_CASE("A stroke that drifts out of the frame goes and does not come back", "[operators]") {
  auto model = showing(tiled(straight_stroke));
  for (double& value : model.drift_x.values) value = -6;
  const auto found = clip(model, 80);
  std::set<std::size_t> counts;
  std::size_t before = 12;
  for (std::size_t t = 0; t < 80; ++t) {
    const auto& graph = found.motion.sketch.frames[t];
    CHECK(vertices_by_stroke(graph) <= before);
    before = vertices_by_stroke(graph);
    counts.insert(before);
    // All of a stroke as long as any of it is in the frame, which it is for 90 px.
    CHECK(graph.size() == 19 * before);
    for (std::size_t v = 0; v < graph.size(); ++v) CHECK(graph.patch(v).position.x > -110);
  }
  CHECK(before == 0);
  CHECK(counts == std::set<std::size_t>{0, 4, 8, 12});
}
