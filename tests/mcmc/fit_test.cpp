// SPDX-License-Identifier: Apache-2.0
#include "mcmc/fit.hpp"

#include "core/error.hpp"
#include "mcmc/synthesize.hpp"
#include "tests/catch.hpp"
#include "tests/mcmc/made_model.hpp"
#include "tests/mcmc/made_scene.hpp"

using namespace emberfold;

namespace {

graph::MotionGraph empty_clip(std::size_t frames) {
  graph::MotionGraph motion;
  motion.sketch.width = 120, motion.sketch.height = 90;
  motion.sketch.frames.resize(frames), motion.links.resize(frames);
  return motion;
}

made::Scene one_stroke(int frames) {
  made::Scene scene;
  scene.width = 200, scene.height = 120, scene.frames = frames;
  scene.strokes = {{{40, 60}, 0.1, 100, 0.004}};
  scene.sway = {1.5, -0.6, 0.2, 30};
  scene.gain = {0.7, 0, 0.05, 30};
  return scene;
}

// What every model that was fitted has to hold.
void check_sound(const mcmc::FitResult& result) {
  CHECK(result.status == core::Status::done);
  CHECK_NOTHROW(mcmc::validate(result.model));
  const auto archive = mcmc::to_archive(result.model);
  CHECK(mcmc::motion_model(archive) == result.model);
  for (const auto& note : result.notes) CHECK(note.find('\n') == std::string::npos);
}

}  // namespace

TEST_CASE("A model is not learned from fewer than two frames", "[fit]") {
  for (const std::size_t frames : {0, 1}) {
    const auto message = make::message<core::InputError>([&] { (void)mcmc::fit(empty_clip(frames)); });
    CHECK(make::has(message, "two frames"));
    CHECK(make::has(message, std::to_string(frames)));
  }
}

TEST_CASE("A clip without a stroke gives a model of nothing", "[fit]") {
  for (const std::size_t frames : {2, 30}) {
    const auto result = mcmc::fit(empty_clip(frames));
    check_sound(result);
    CHECK(!result.notes.empty());
    CHECK(result.model.exemplars.empty());
    CHECK(result.model.frames == static_cast<int>(frames));
    for (const auto& graph : mcmc::synthesize(result.model, 20, 1).motion.sketch.frames) CHECK(graph.empty());
  }
}

TEST_CASE("Frames without strokes among others are no trouble", "[fit]") {
  auto scene = one_stroke(40);
  scene.strokes[0].born = 10, scene.strokes[0].dies = 25;
  const auto result = mcmc::fit(made::make(scene, 1).motion);
  check_sound(result);
  CHECK(result.counts.events[0] == 1);
  CHECK(result.counts.events[1] == 1);
  CHECK_NOTHROW(mcmc::synthesize(result.model, 50, 1));
}

TEST_CASE("One stroke makes a model that keeps it", "[fit]") {
  const auto scene = one_stroke(120);
  const auto result = mcmc::fit(made::make(scene, 2).motion);
  check_sound(result);
  const auto& model = result.model;
  CHECK(model.width == 200);
  CHECK(model.height == 120);
  CHECK(model.fps == 25);
  CHECK(graph::components(model.first).count == 1);
  // The rest shape lies along the curve at rest, whatever frame it was taken from: sways are of SD 0.7 px, of
  // which the mean over 120 frames does not know 0.2.
  const auto& stroke = scene.strokes[0];
  for (const auto& vertex : model.first.vertices()) {
    double nearest = 1e9;
    for (double s = -5; s <= stroke.length + 5; s += 0.1)
      nearest = std::min(nearest, graph::distance(stroke.at(s), vertex.patch.position));
    CHECK(nearest < 0.8);
  }
  for (const auto& graph : mcmc::synthesize(model, 100, 3).motion.sketch.frames)
    CHECK(graph::components(graph).count == 1);
}

TEST_CASE("Two frames make a model that says what it does not know", "[fit]") {
  made::Scene scene;
  scene.frames = 2;
  scene.strokes = made::scattered(4, 3, scene.width, scene.height, 50);
  scene.sway = {1.5, -0.6, 0.2, 30};
  const auto result = mcmc::fit(made::make(scene, 4).motion);
  check_sound(result);
  // Sway, contrast and rates.
  CHECK(result.notes.size() >= 3);
  CHECK(result.model.sway == mcmc::Autoregression{});
  CHECK(result.model.contrast == mcmc::Autoregression{});
  const auto clip = mcmc::synthesize(result.model, 30, 1).motion;
  CHECK(graph::components(clip.sketch.frames[0]).count == 12);
  CHECK(graph::components(clip.sketch.frames[29]).count == 12);
}

TEST_CASE("The laws of sway and contrast of a made scene are learned", "[fit]") {
  made::Scene scene;
  scene.frames = 300;
  scene.strokes = made::scattered(6, 4, scene.width, scene.height, 50);
  scene.sway = {1.5, -0.6, 0.25, 25};
  scene.gain = {1.2, -0.4, 0.06, 20};
  const auto result = mcmc::fit(made::make(scene, 5).motion);
  check_sound(result);
  const auto close = [](const mcmc::Autoregression& found, const made::Law& law) {
    CHECK_THAT(found.a1, Catch::Matchers::WithinRel(law.a1, 0.1));
    CHECK_THAT(found.a2, Catch::Matchers::WithinRel(law.a2, 0.15));
    CHECK_THAT(mcmc::stationary_deviation(found), Catch::Matchers::WithinRel(law.deviation(), 0.1));
    CHECK_THAT(found.range, Catch::Matchers::WithinRel(law.range, 0.2));
  };
  close(result.model.sway, scene.sway);
  close(result.model.contrast, scene.gain);
  // Nobody drifts and nobody changes.
  for (std::size_t c = 0; c < result.model.drift_x.values.size(); ++c)
    CHECK(std::abs(result.model.drift_x.values[c]) + std::abs(result.model.drift_y.values[c]) < 0.03);
  CHECK(result.counts.events == std::array<double, 6>{});
}

TEST_CASE("The same clip gives the same model and a cancelled fit says so", "[fit]") {
  made::Scene scene;
  scene.frames = 60;
  scene.strokes = made::living(0.4, 0.05, scene.frames, scene.width, scene.height, 6);
  scene.sway = {1.5, -0.6, 0.2, 30};
  const auto motion = made::make(scene, 7).motion;
  const auto one = mcmc::fit(motion, {9}), again = mcmc::fit(motion, {9});
  CHECK(one.model == again.model);
  CHECK(one.notes == again.notes);
  std::stop_source stop;
  stop.request_stop();
  const core::Context context(stop.get_token());
  CHECK(mcmc::fit(motion, {9}, context).status == core::Status::cancelled);
  CHECK(mcmc::synthesize(one.model, 10, 1, context).status == core::Status::cancelled);
}
