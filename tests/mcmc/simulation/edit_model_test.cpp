// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/edit_model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/event_statistics.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using graph::EventType;
using mcmc::MotionEdit;

namespace {

// Some thirty strokes that come, go, fall into pieces and grow together.
mcmc::MotionModel make_lively(double split, double merge, double connect, double disconnect) {
  auto model = test::empty_model();
  for (int i = 0; i < 24; ++i) {
    const graph::Point place{30 + 52.0 * (i % 6), 30 + 58.0 * (i / 6)};
    model.exemplars.push_back({test::straight(i % 2 == 0 ? 7 : 12, 0.5 * i), place, 8});
  }
  model.rates.birth_by_size = {0, 0.5, 0.5, 0, 0, 0, 0};
  for (double& value : model.rates.birth.values) value = 0.8 / (320 * 240);
  model.rates.death_by_size.fill(0.04);
  model.rates.split = split, model.rates.merge = merge, model.rates.connect = connect;
  model.rates.disconnect = disconnect;
  model.displacement = {1.4, -0.5, 0.05, 0.3, 20, 0};
  model.contrast = {0.8, 0.1, 0, 0.03, 20, 0};
  for (double& value : model.density.values) value = 0.6;
  model.first = model.exemplars[0].graph;
  // It begins, and is as dense, as it stays.
  MotionEdit edit;
  edit.rates[0] = 1.0000001;
  return mcmc::edit_motion(model, edit).model;
}
mcmc::MotionModel lively() {
  static const mcmc::MotionModel model = make_lively(0.015, 0.2, 0.03, 0.08);
  return model;
}

// Events a frame in a long clip.
mcmc::EventStatistics seen(const mcmc::MotionModel& model, int frames = 1200) {
  mcmc::Synthesis synthesis(model, 99);
  mcmc::EventStatistics mean;
  (void)synthesis.next();
  for (int t = 0; t < frames; ++t) {
    const auto graph = synthesis.next();
    mean.patches += double(graph.size()) / frames;
    for (std::size_t i = 0; i < mean.events.size(); ++i)
      mean.events[i] += double(synthesis.operators()[i]) / frames;
  }
  return mean;
}

double of(const mcmc::EventStatistics& statistics, EventType type) {
  return statistics.events[static_cast<std::size_t>(type)];
}

// Four SD of a Poisson count in so many frames, and what settling may be off by.
double tolerance(double rate, int frames = 1200) {
  return 4 * std::sqrt(rate / frames) + 0.08 * rate;
}

}  // namespace

TEST_CASE("A neutral edit changes nothing", "[edit_motion]") {
  const auto model = test::full_model();
  CHECK(mcmc::edit_motion(model, {}).model == model);
  CHECK(mcmc::edit_motion(model, {}).notes.empty());
  MotionEdit same;
  same.speed = 1, same.intensity = 1, same.flicker = 1, same.rates.fill(1);
  CHECK(core::ModelArchive(mcmc::to_archive(mcmc::edit_motion(model, same, 5).model)).text ==
        mcmc::to_archive(model).text);
}

TEST_CASE("Edits out of range are refused by name", "[edit_motion][heavy]") {
  const auto refused = [](auto change, const std::string& name) {
    MotionEdit edit;
    change(edit);
    CHECK_THROWS_WITH(edit.validate(), Catch::Matchers::Contains(name));
  };
  refused([](MotionEdit& e) { e.speed = 0; }, "speed is 0, must be in 0.1…10");
  refused([](MotionEdit& e) { e.speed = std::nan(""); }, "speed");
  refused([](MotionEdit& e) { e.intensity = -1; }, "intensity");
  refused([](MotionEdit& e) { e.flicker = 11; }, "flicker");
  refused([](MotionEdit& e) { e.contrast = 0; }, "contrast is 0");
  refused([](MotionEdit& e) { e.wind.y = -9; }, "wind is -9");
  refused([](MotionEdit& e) { e.rates[3] = -0.5; }, "merges");
  refused([](MotionEdit& e) { e.rates[1] = 0; }, "at most 4 times the deaths");
  refused([](MotionEdit& e) { e.birth_map = test::map_over(320, 240, 16, 0); }, "nothing is painted");
  MotionEdit edit;
  edit.birth_map = test::map_over(320, 240, 20, 1);
  CHECK_THROWS_AS(mcmc::edit_motion(lively(), edit), core::InputError);
  edit = {};
  edit.strokes = mcmc::StrokeChoice::coarse;
  CHECK_THROWS_AS(mcmc::edit_motion(lively(), edit), core::InputError);  // all are alike
}

TEST_CASE("A law at twice the speed is that of every other frame", "[edit_motion]") {
  const mcmc::Autoregression slow{1.6, -0.68, 0, 0.3, 12, 0.1};  // complex poles
  const auto fast = mcmc::change_speed(slow, 2);
  const std::complex<double> pole =
      (slow.a1 + std::sqrt(std::complex<double>(slow.a1 * slow.a1 + 4 * slow.a2))) / 2.0;
  CHECK_THAT(fast.a1, Catch::Matchers::WithinAbs(2 * (pole * pole).real(), 1e-12));
  CHECK_THAT(fast.a2, Catch::Matchers::WithinAbs(-std::norm(pole) * std::norm(pole), 1e-12));
  CHECK_THAT(mcmc::stationary_deviation(fast),
             Catch::Matchers::WithinRel(mcmc::stationary_deviation(slow), 1e-9));
  // There and back again.
  const auto back = mcmc::change_speed(mcmc::change_speed(slow, 0.5), 2);
  CHECK_THAT(back.a1, Catch::Matchers::WithinAbs(slow.a1, 1e-9));
  CHECK_THAT(back.a2, Catch::Matchers::WithinAbs(slow.a2, 1e-9));
  CHECK_THAT(back.noise, Catch::Matchers::WithinRel(slow.noise, 1e-9));
  // Whatever the speed, what was stable stays so, and swings as far.
  for (const auto& law :
       {slow, mcmc::Autoregression{0.3, 0.2, 0.1, 1, 0, 0}, mcmc::Autoregression{-0.4, 0.3, 0, 1, 5, 0},
        mcmc::Autoregression{1.98, -0.985, 0.01, 0.1, 30, 0}})
    for (const double factor : {0.1, 0.5, 1.7, 10.0}) {
      const auto other = mcmc::change_speed(law, factor);
      CAPTURE(law.a1, law.a2, law.coupling, factor);
      CHECK(mcmc::spectral_radius(other) < 1);
      CHECK_THAT(mcmc::stationary_deviation(other),
                 Catch::Matchers::WithinRel(mcmc::stationary_deviation(law), 1e-6));
    }
}

TEST_CASE("Intensity scales how far strokes sway and nothing else", "[edit_motion][heavy]") {
  auto model = lively();
  MotionEdit edit;
  edit.intensity = 2.5, edit.flicker = 0.5;
  const auto edited = mcmc::edit_motion(model, edit).model;
  CHECK_THAT(mcmc::stationary_deviation(edited.displacement),
             Catch::Matchers::WithinRel(2.5 * mcmc::stationary_deviation(model.displacement), 1e-12));
  CHECK_THAT(mcmc::stationary_deviation(edited.contrast),
             Catch::Matchers::WithinRel(0.5 * mcmc::stationary_deviation(model.contrast), 1e-12));
  model.displacement.noise = edited.displacement.noise, model.contrast.noise = edited.contrast.noise;
  CHECK(edited == model);
}

TEST_CASE("Events happen as often as an edit asks for", "[edit_motion][slow]") {
  const auto model = lively();
  const auto before = seen(model);
  for (const auto type : {EventType::birth, EventType::split, EventType::merge, EventType::connect})
    CHECK(of(before, type) > 0.015);  // enough to be counted
  const auto check = [&](EventType type, double factor) {
    MotionEdit edit;
    edit.rates[static_cast<std::size_t>(type)] = factor;
    const auto result = mcmc::edit_motion(model, edit);
    const double wanted = factor * of(before, type), found = of(seen(result.model), type);
    CAPTURE(graph::name(type), factor, wanted, found);
    CHECK(result.notes.empty());
    if (factor == 0)
      CHECK(found == 0);
    else
      CHECK(std::abs(found - wanted) < tolerance(wanted));
  };
  check(EventType::birth, 2);
  check(EventType::split, 0);
  check(EventType::split, 2);
  check(EventType::merge, 0);
  check(EventType::connect, 2);
}

TEST_CASE("Faster and backwards, everything happens as often as that says", "[edit_motion][slow]") {
  auto model = make_lively(0.002, 0.02, 0.01, 0.004);
  for (double& value : model.drift_x.values) value = 0.2;
  const auto before = seen(model);
  MotionEdit edit;
  SECTION("at another speed") {
    edit.speed = GENERATE(0.5, 2.0);
    const auto edited = mcmc::edit_motion(model, edit).model;
    const auto after = seen(edited);
    CHECK_THAT(edited.drift_x.values[0], Catch::Matchers::WithinRel(0.2 * edit.speed, 1e-12));
    for (std::size_t i = 0; i < 6; ++i) {
      const double wanted = edit.speed * before.events[i];
      CAPTURE(i, wanted, after.events[i]);
      // The wanted number is also an estimate from counts, here and in the edit.
      const double counted = 2 * edit.speed * edit.speed * before.events[i];
      CHECK(std::abs(after.events[i] - wanted) < 4 * std::sqrt((wanted + counted) / 1200) + 0.13 * wanted);
    }
    CHECK_THAT(after.patches, Catch::Matchers::WithinRel(before.patches, 0.15));
  }
  SECTION("backwards") {
    edit.reverse = true;
    model.appearing = {0.25, 0.5, 0.75, 1, 1, 1, 1, 1};
    const auto edited = mcmc::edit_motion(model, edit).model;
    CHECK(edited.drift_x.values[0] == -0.2);
    CHECK(edited.vanishing == model.appearing);
    CHECK(edited.appearing == model.vanishing);
    const auto after = seen(edited);
    for (const auto& [type, other] : {std::pair{EventType::birth, EventType::death},
                                      {EventType::split, EventType::merge},
                                      {EventType::connect, EventType::disconnect}}) {
      CAPTURE(graph::name(type), of(before, type), of(before, other), of(after, type), of(after, other));
      CHECK(std::abs(of(after, type) - of(before, other)) < tolerance(of(before, other)) + 0.05);
      CHECK(std::abs(of(after, other) - of(before, type)) < tolerance(of(before, type)) + 0.05);
    }
    // Long strokes come about in another way, so that how many patches there are is kept roughly.
    CHECK_THAT(after.patches, Catch::Matchers::WithinRel(before.patches, 0.4));
  }
}

TEST_CASE("Strokes are born where the map is painted", "[edit_motion][heavy]") {
  const auto model = lively();
  MotionEdit edit;
  edit.birth_map = test::map_over(320, 240, 16, 0);
  for (int row = 2; row < 13; ++row)
    for (int column = 12; column < 18; ++column)
      edit.birth_map->values[static_cast<std::size_t>(row * edit.birth_map->columns + column)] = 1;
  const auto edited = mcmc::edit_motion(model, edit).model;
  const auto motion = mcmc::synthesize(edited, 300, 3);
  int births = 0, inside = 0;
  for (const auto& event : graph::stroke_events(motion)) {
    if (event.type != EventType::birth) continue;
    ++births;
    inside +=
        event.position.x > 180 && event.position.x < 300 && event.position.y > 20 && event.position.y < 220;
  }
  CHECK(births > 120);
  CHECK(double(inside) > 0.95 * births);
}

TEST_CASE("Contrast is scaled and nothing else", "[edit_motion][heavy]") {
  MotionEdit edit;
  edit.contrast = 2;
  mcmc::Synthesis before(lively(), 5), after(mcmc::edit_motion(lively(), edit).model, 5);
  for (int t = 0; t < 40; ++t) {
    const auto was = before.next(), is = after.next();
    REQUIRE(was.size() == is.size());
    for (std::uint32_t v = 0; v < was.size(); ++v) {
      CHECK(is.patch(v).position == was.patch(v).position);
      CHECK_THAT(is.patch(v).contrast, Catch::Matchers::WithinRel(2 * was.patch(v).contrast, 1e-9));
    }
  }
}

TEST_CASE("Wind carries strokes, and what it carries away is born on its other side", "[edit_motion][slow]") {
  MotionEdit edit;
  edit.wind = {1.5, -0.5};
  const auto still = lively(), blown = mcmc::edit_motion(still, edit).model;
  CHECK(blown.drift_x.values.front() == still.drift_x.values.front() + 1.5);
  const auto before = seen(still), after = seen(blown);
  CHECK_THAT(after.patches, Catch::Matchers::WithinRel(before.patches, 0.3));
  const auto motion = mcmc::synthesize(blown, 300, 3);
  graph::Point way;
  double links = 0;
  for (std::size_t t = 1; t < motion.links.size(); ++t)
    for (const auto& link : motion.links[t]) {
      const auto& then = motion.sketch.frames[t - 1];
      const auto& now = motion.sketch.frames[t];
      way = way +
            (now.patch(now.index_of(link.after)).position - then.patch(then.index_of(link.before)).position);
      ++links;
    }
  REQUIRE(links > 1000);
  CHECK_THAT(way.x / links, Catch::Matchers::WithinAbs(1.5, 0.1));
  CHECK_THAT(way.y / links, Catch::Matchers::WithinAbs(-0.5, 0.1));
  // Strokes a frame over the width, times the wind, come in from the left; the frame is filled evenly.
  double left = 0, right = 0;
  for (const auto& graph : motion.sketch.frames)
    for (const auto& vertex : graph.vertices()) (vertex.patch.position.x < 160 ? left : right) += 1;
  CHECK(std::abs(left - right) < 0.4 * (left + right));
}

TEST_CASE("Coarse and fine strokes are each other's rest", "[edit_motion][slow]") {
  auto model = lively();
  for (std::size_t i = 0; i < model.exemplars.size(); i += 3) {
    auto vertices =
        std::vector(model.exemplars[i].graph.vertices().begin(), model.exemplars[i].graph.vertices().end());
    for (auto& v : vertices) v.patch.width = 9;
    const auto edges = model.exemplars[i].graph.edges();
    model.exemplars[i].graph = {std::move(vertices), {edges.begin(), edges.end()}};
  }
  MotionEdit edit;
  edit.strokes = mcmc::StrokeChoice::coarse;
  const auto coarse = mcmc::edit_motion(model, edit).model;
  edit.strokes = mcmc::StrokeChoice::fine;
  const auto fine = mcmc::edit_motion(model, edit).model;
  CHECK(coarse.exemplars.size() + fine.exemplars.size() == model.exemplars.size());
  CHECK(coarse.exemplars.size() == 8);
  const auto all_wide = [](const graph::AttributeGraph& graph) {
    return std::ranges::all_of(graph.vertices(), [](const auto& v) { return v.patch.width == 9; });
  };
  for (const auto& exemplar : coarse.exemplars) CHECK(all_wide(exemplar.graph));
  for (const auto& exemplar : fine.exemplars) CHECK(!all_wide(exemplar.graph));
  // A third of the births were of coarse strokes.
  const double births = of(seen(model, 600), EventType::birth);
  const double left = of(seen(coarse, 600), EventType::birth);
  CHECK(std::abs(left - births / 3) < tolerance(births / 3, 600));
}
