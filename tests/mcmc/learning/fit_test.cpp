// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/fit.hpp"

#include "core/error.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/motion_models.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;

namespace {

graph::MotionGraph empty_clip(std::size_t frames) {
  graph::MotionGraph motion;
  motion.sketch.width = 120, motion.sketch.height = 90;
  motion.sketch.frames.resize(frames), motion.links.resize(frames);
  return motion;
}

test::Scene one_stroke(int frames) {
  test::Scene scene;
  scene.width = 200, scene.height = 120, scene.frames = frames;
  scene.strokes = {{{40, 60}, 0.1, 100, 0.004}};
  scene.displacement = {1.5, -0.6, 0.2, 30};
  scene.gain = {0.7, 0, 0.05, 30};
  return scene;
}

// Checks that every fitted model must pass.
void check_sound(const mcmc::FitResult& result) {
  CHECK_NOTHROW(mcmc::validate(result.model));
  const auto archive = mcmc::to_archive(result.model);
  CHECK(mcmc::motion_model(archive) == result.model);
  for (const auto& note : result.notes) CHECK(note.find('\n') == std::string::npos);
}

}  // namespace

TEST_CASE("A model is not learned from fewer than two frames", "[fit]") {
  for (const std::size_t frames : {0, 1}) {
    const auto message = test::message_of<core::InputError>([&] { (void)mcmc::fit(empty_clip(frames)); });
    CHECK(test::contains(message, "two frames"));
    CHECK(test::contains(message, std::to_string(frames)));
  }
}

TEST_CASE("A clip without a stroke gives a model of nothing", "[fit]") {
  for (const std::size_t frames : {2, 30}) {
    const auto result = mcmc::fit(empty_clip(frames));
    check_sound(result);
    CHECK(!result.notes.empty());
    CHECK(result.model.exemplars.empty());
    CHECK(result.model.frames == static_cast<int>(frames));
    for (const auto& graph : mcmc::synthesize(result.model, 20, 1).sketch.frames) CHECK(graph.empty());
  }
}

TEST_CASE("Frames without strokes among others are no trouble", "[fit]") {
  auto scene = one_stroke(40);
  scene.strokes[0].born = 10, scene.strokes[0].dies = 25;
  const auto result = mcmc::fit(test::make(scene, 1).motion);
  check_sound(result);
  CHECK(result.counts.events[0] == 1);
  CHECK(result.counts.events[1] == 1);
  CHECK_NOTHROW(mcmc::synthesize(result.model, 50, 1));
}

TEST_CASE("One stroke makes a model that keeps it", "[fit]") {
  const auto scene = one_stroke(120);
  const auto clip = test::make(scene, 2).motion;
  const auto result = mcmc::fit(clip);
  check_sound(result);
  const auto& model = result.model;
  CHECK(model.width == 200);
  CHECK(model.height == 120);
  CHECK(model.fps == 25);
  CHECK(graph::components(model.first).count == 1);
  // It begins with one of the clip's frames, in its shape.
  CHECK(std::ranges::any_of(clip.sketch.frames, [&](const auto& frame) {
    return std::ranges::equal(
        frame.vertices(), model.first.vertices(), {}, [](const auto& v) { return v.patch.position; },
        [](const auto& v) { return v.patch.position; });
  }));
  for (const auto& graph : mcmc::synthesize(model, 100, 3).sketch.frames)
    CHECK(graph::components(graph).count == 1);
}

TEST_CASE("Two frames make a model that says what it does not know", "[fit]") {
  test::Scene scene;
  scene.frames = 2;
  scene.strokes = test::scattered(4, 3, scene.width, scene.height, 50);
  scene.displacement = {1.5, -0.6, 0.2, 30};
  const auto result = mcmc::fit(test::make(scene, 4).motion);
  check_sound(result);
  // Sway, contrast and rates.
  CHECK(result.notes.size() >= 3);
  CHECK(result.model.displacement == mcmc::Autoregression{});
  CHECK(result.model.contrast == mcmc::Autoregression{});
  const auto clip = mcmc::synthesize(result.model, 30, 1);
  CHECK(graph::components(clip.sketch.frames[0]).count == 12);
  CHECK(graph::components(clip.sketch.frames[29]).count == 12);
}

TEST_CASE("The laws of sway and contrast of a made scene are learned", "[fit]") {
  test::Scene scene;
  scene.frames = 300;
  scene.strokes = test::scattered(6, 4, scene.width, scene.height, 50);
  scene.displacement = {1.5, -0.6, 0.25, 25};
  scene.gain = {1.2, -0.4, 0.06, 20};
  const auto result = mcmc::fit(test::make(scene, 5).motion);
  check_sound(result);
  const auto close = [](const mcmc::Autoregression& found, const test::Law& law) {
    CHECK_THAT(found.a1, Catch::Matchers::WithinRel(law.a1, 0.1));
    CHECK_THAT(found.a2, Catch::Matchers::WithinRel(law.a2, 0.15));
    CHECK_THAT(mcmc::stationary_deviation(found), Catch::Matchers::WithinRel(law.deviation(), 0.1));
    CHECK_THAT(found.range, Catch::Matchers::WithinRel(law.range, 0.2));
  };
  close(result.model.displacement, scene.displacement);
  close(result.model.contrast, scene.gain);
  // Nobody drifts and nobody changes.
  for (std::size_t c = 0; c < result.model.drift_x.values.size(); ++c)
    CHECK(std::abs(result.model.drift_x.values[c]) + std::abs(result.model.drift_y.values[c]) < 0.03);
  CHECK(result.counts.events == std::array<double, 6>{});
}

TEST_CASE("The same clip gives the same model and a cancelled fit throws", "[fit]") {
  test::Scene scene;
  scene.frames = 60;
  scene.strokes = test::living(0.4, 0.05, scene.frames, scene.width, scene.height, 6);
  scene.displacement = {1.5, -0.6, 0.2, 30};
  const auto motion = test::make(scene, 7).motion;
  const auto one = mcmc::fit(motion, {9}), again = mcmc::fit(motion, {9});
  CHECK(one.model == again.model);
  CHECK(one.notes == again.notes);
  std::stop_source stop;
  stop.request_stop();
  const core::Context context(stop.get_token());
  CHECK_THROWS_AS(mcmc::fit(motion, {9}, context), core::Cancelled);
  CHECK_THROWS_AS(mcmc::synthesize(one.model, 10, 1, context), core::Cancelled);
}
