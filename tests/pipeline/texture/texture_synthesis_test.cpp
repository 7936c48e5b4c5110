// SPDX-License-Identifier: Apache-2.0
#include "pipeline/texture/texture_synthesis.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/footage/footage.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_frames.hpp"
#include "tests/support/drawn_models.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using pipeline::SynthesisMethod;

namespace {

/// A model of a clip in which three waves sway, each by itself, over a ramp.
pipeline::ClipModel swaying_model(int frames, int channels = 1) {
  core::Clip clip;
  clip.info.width = 32, clip.info.height = 24, clip.info.channels = channels;
  core::Rng rng(5);
  std::array<double, 3> sway{};
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(24, 32, CV_8UC(channels));
    for (double& state : sway) state = 0.7 * state + 10 * rng.normal();
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        for (int c = 0; c < channels; ++c) {
          double level = 100 + x + 20 * c;
          for (std::size_t k = 0; k < sway.size(); ++k)
            level += sway[k] * std::sin(0.2 * (static_cast<double>(k) + 1) * (x + 0.5 * y));
          frame.ptr<std::uint8_t>(y)[channels * x + c] = cv::saturate_cast<std::uint8_t>(level);
        }
    clip.frames.push_back(frame);
  }
  core::ClipSource source(clip);
  pipeline::ClipModel model;
  model.motion = made_model(32, 24, 8);
  model.footage = pipeline::gather_footage(source, {}, {});
  return model;
}

/// The mean and SD over time of every value of the frames.
struct OverTime {
  cv::Mat mean, deviation;
  explicit OverTime(const std::vector<cv::Mat>& frames) {
    cv::Mat sum, squares;
    for (const auto& frame : frames) {
      cv::Mat levels;
      frame.reshape(1).convertTo(levels, CV_64F, 1.0 / static_cast<double>(frames.size()));
      sum = sum.empty() ? levels : cv::Mat(sum + levels);
      const cv::Mat square = levels.mul(levels, static_cast<double>(frames.size()));
      squares = squares.empty() ? square : cv::Mat(squares + square);
    }
    mean = sum;
    cv::sqrt(squares - sum.mul(sum), deviation);
  }
};

}  // namespace

TEST_CASE("a texture of footage has its colours, its mean and its variance over time") {
  const auto model = swaying_model(300, GENERATE(1, 3));
  pipeline::ClipSynthesis synthesis(model, {.method = SynthesisMethod::texture});
  const auto source = decode(*model.footage), drawn = draw(synthesis, 900);
  REQUIRE(drawn[0].type() == source[0].type());
  CHECK(synthesis.info().channels == source[0].channels());
  const OverTime before(source), after(drawn);
  CHECK(cv::norm(before.mean, after.mean, cv::NORM_INF) < 5);
  CHECK_THAT(cv::mean(after.deviation)[0] / cv::mean(before.deviation)[0], WithinAbs(1, 0.1));
}

TEST_CASE("a texture of footage is the same at any number of threads and calls, and anew from its seed") {
  const auto model = swaying_model(40, 3);  // fewer frames than components by default
  const pipeline::ClipSynthesisOptions options{.seed = 3, .method = SynthesisMethod::texture};
  pipeline::ClipSynthesis whole(model, options), parts(model, options);
  const core::ThreadLimit two(2);
  const auto frames = draw(whole, 24);
  auto first = [&] {
    const core::ThreadLimit one(1);
    return draw(parts, 7);
  }();
  const auto rest = draw(parts, 17);
  first.insert(first.end(), rest.begin(), rest.end());
  CHECK(same_frames(frames, first));
  whole.rewind();
  CHECK(same_frames(frames, draw(whole, 24)));
  pipeline::ClipSynthesis other(model, {.seed = 4, .method = SynthesisMethod::texture});
  CHECK_FALSE(same_frames(frames, draw(other, 24)));
}

TEST_CASE("a texture of footage refuses what it cannot do") {
  auto model = swaying_model(12);
  const auto refusal = [&](pipeline::ClipSynthesisOptions options) {
    options.method = SynthesisMethod::texture;
    return message_of<core::InputError>([&] { pipeline::ClipSynthesis(model, options); });
  };
  CHECK(refusal({}).empty());
  CHECK(contains(refusal({.speed = 2}), "speed"));
  mcmc::MotionEdit wind;
  wind.wind = {1, 0};
  CHECK(contains(refusal({.edit = wind}), "edit"));
  CHECK(contains(refusal({.loop = 9}), "loop"));
  const pipeline::ClipSynthesis synthesis(model, {.method = SynthesisMethod::texture});
  CHECK(synthesis.statistics() == nullptr);
  CHECK(contains(message_of<core::InputError>([&] { (void)synthesis.motion(3); }), "no strokes"));
  model.footage->frames.resize(1);
  CHECK(contains(refusal({}), "two frames"));
  model.footage.reset();
  CHECK(contains(refusal({}), "no frames of its clip"));
}
