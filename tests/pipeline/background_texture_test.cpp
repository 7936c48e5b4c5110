// SPDX-License-Identifier: Apache-2.0
#include "pipeline/background_texture.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <stop_token>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/synthesize.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_models.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const cv::Size kSize(64, 48);
constexpr int kFrames = 48;

/// A ground of two standing waves that go round, and bright strokes that wander over it.
struct Scene {
  core::Clip clip, ground;
  std::vector<graph::AttributeGraph> graphs;
};

float wave(int x, int y, int t) {
  const double phase = 2 * std::numbers::pi * t / 12;
  return static_cast<float>(90 +
                            25 * (std::cos(phase) * std::sin(0.4 * x) + std::sin(phase) * std::sin(0.3 * y)));
}

Scene make_scene() {
  Scene scene;
  const auto strokes = made_strokes(4, kSize.width, kSize.height, kFrames);
  const auto motion = made_motion(strokes, kSize.width, kSize.height, kFrames);
  scene.graphs = motion.sketch.frames;
  for (auto* clip : {&scene.clip, &scene.ground})
    clip->info = {kSize.width, kSize.height, 1, CV_8U, 25, 255, kFrames};
  for (int t = 0; t < kFrames; ++t) {
    cv::Mat frame(kSize, CV_8U);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) frame.at<uchar>(y, x) = cv::saturate_cast<uchar>(wave(x, y, t));
    scene.ground.frames.push_back(frame.clone());
    // Far from the ground's levels, and never twice the same.
    frame.setTo(200 + (37 * t) % 50,
                sketch::draw_fitted(scene.graphs[static_cast<std::size_t>(t)], kSize, 1).mask);
    scene.clip.frames.push_back(frame);
  }
  return scene;
}

pipeline::BackgroundTexture learn(const Scene& scene,
                                  const pipeline::BackgroundTextureOptions& options = {}) {
  core::ClipSource source(scene.clip);
  return pipeline::learn_background_texture(source, scene.graphs, options);
}

double distance(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L2) / std::sqrt(static_cast<double>(a.total()));
}

}  // namespace

TEST_CASE("a texture between strokes is learned as if there were none") {
  const Scene scene = make_scene();
  const auto learned = learn(scene, {.components = 2, .rounds = 12});
  CHECK(learned.hidden > 0.05);
  CHECK(learned.hidden < 0.6);
  REQUIRE(learned.texture.components() == 2);
  REQUIRE(learned.texture.info.frames == kFrames);
  double worst = 0, plain = 0;
  for (int t = 0; t < kFrames; ++t) {
    const auto index = static_cast<std::size_t>(t);
    cv::Mat truth, shown;
    scene.ground.frames[index].convertTo(truth, CV_32F);
    scene.clip.frames[index].convertTo(shown, CV_32F);
    worst = std::max(worst, distance(dytex::draw(learned.texture, learned.texture.states.col(t)), truth));
    plain = std::max(plain, distance(shown, truth));
  }
  CHECK(plain > 20);
  CHECK(worst < 1.5);
  // A wave that goes round in 12 frames.
  const auto& A = learned.texture.A;
  const double turn = std::acos(A.trace() / (2 * std::sqrt(A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0))));
  CHECK_THAT(turn, Catch::Matchers::WithinAbs(2 * std::numbers::pi / 12, 0.02));
}

TEST_CASE("a texture of sixteen bits is that of eight, on its own scale") {
  const auto scene = make_scene();
  core::Clip deep{scene.clip.info, {}};
  deep.info.depth = CV_16U, deep.info.white = 65535;
  for (const auto& frame : scene.clip.frames) {
    cv::Mat words;
    frame.convertTo(words, CV_16U, 257);
    deep.frames.push_back(words);
  }
  pipeline::BackgroundTextureOptions options;
  options.components = 4, options.rounds = 0;
  core::ClipSource eight(scene.clip), sixteen(deep);
  const auto a = pipeline::learn_background_texture(eight, scene.graphs, options, {});
  const auto b = pipeline::learn_background_texture(sixteen, scene.graphs, options, {});
  CHECK(a.texture.mean.maxCoeff() > 60);
  CHECK((b.texture.mean - a.texture.mean).cwiseAbs().maxCoeff() < 1);
}

TEST_CASE("strokes are hidden, whatever they show") {
  Scene scene = make_scene();
  const auto learned = learn(scene, {.components = 3, .rounds = 2});
  for (std::size_t t = 0; t < scene.clip.frames.size(); ++t)
    scene.clip.frames[t].setTo(11, sketch::draw_fitted(scene.graphs[t], kSize, 1).mask);
  const auto other = learn(scene, {.components = 3, .rounds = 2});
  CHECK(learned.texture.mean == other.texture.mean);
  CHECK(learned.texture.C == other.texture.C);
  CHECK(learned.texture.A == other.texture.A);
  CHECK(learned.texture.states == other.texture.states);
}

TEST_CASE("a texture between strokes is the same at any number of threads") {
  const Scene scene = make_scene();
  std::vector<pipeline::BackgroundTexture> learned;
  for (const std::size_t threads : {1, 4}) {
    const core::ThreadLimit limit(threads);
    learned.push_back(learn(scene, {.components = 3, .rounds = 2}));
  }
  CHECK(learned[0].texture.C == learned[1].texture.C);
  CHECK(learned[0].texture.states == learned[1].texture.states);
}

TEST_CASE(
    "too few frames, other graphs and bad options are refused, and a short clip gives fewer components") {
  Scene scene = make_scene();
  core::ClipSource source(scene.clip);
  const auto refused = [&](std::size_t graphs, const pipeline::BackgroundTextureOptions& options) {
    return message_of<core::InputError>([&] {
      (void)pipeline::learn_background_texture(source, std::span(scene.graphs).first(graphs), options);
    });
  };
  CHECK(contains(refused(40, {}), "48 frames has 40 graphs"));
  CHECK(contains(refused(48, {.components = 0}), "components is 0"));
  CHECK(contains(refused(48, {.rounds = -1}), "rounds is -1"));
  const auto learned = learn(scene);
  CHECK(learned.texture.components() <= 16);
  REQUIRE_FALSE(learned.notes.empty());
  CHECK(contains(learned.notes.front(), "48 frames give 16 components"));
  std::stop_source stop;
  stop.request_stop();
  CHECK_THROWS_AS(
      pipeline::learn_background_texture(source, scene.graphs, {}, core::Context(stop.get_token())),
      core::Cancelled);
  scene.clip.frames.resize(4), scene.graphs.resize(4), scene.clip.info.frames = 4;
  CHECK(contains(message_of<core::InputError>([&] { (void)learn(scene); }), "at least 6 frames"));
}

TEST_CASE("hybrid frames go on without regard to how they are asked for, and need a texture that fits") {
  const Scene scene = make_scene();
  const auto texture =
      std::make_shared<const dytex::LinearDynamicTexture>(learn(scene, {.components = 3}).texture);
  auto model = made_model(kSize.width, kSize.height, 16);
  auto all = pipeline::hybrid_frames(model, texture, pipeline::render_options(model, {}), 4),
       parts = pipeline::hybrid_frames(model, texture, pipeline::render_options(model, {}), 4),
       other = pipeline::hybrid_frames(model, texture, pipeline::render_options(model, {}), 5);
  const auto whole = all.next(30);
  std::vector<cv::Mat> pieces;
  for (const int count : {1, 12, 17})
    for (const auto& frame : parts.next(count)) pieces.push_back(frame);
  REQUIRE(pieces.size() == whole.size());
  for (std::size_t t = 0; t < whole.size(); ++t) {
    CHECK(whole[t].type() == CV_8UC1);
    CHECK(same_pixels(whole[t], pieces[t]));
  }
  CHECK_FALSE(same_pixels(whole[3], other.next(4)[3]));
  CHECK(all.statistics().patches.size() == 30);
  model = made_model(80, 48, 16);
  CHECK(contains(message_of<core::InputError>([&] { (void)pipeline::hybrid_frames(model, texture, {}, 1); }),
                 "64x48, the model 80x48"));
}
