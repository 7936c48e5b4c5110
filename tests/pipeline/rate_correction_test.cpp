// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rate_correction.hpp"

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_motion.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

pipeline::ClipModel waiting_model() {
  const int width = 120, height = 90, frames = 16;
  const auto strokes = made_strokes(8, width, height, frames);
  core::Clip clip;
  clip.info.width = width, clip.info.height = height, clip.info.channels = 3, clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) clip.frames.push_back(made_picture(strokes, width, height, t));
  core::ClipSource source(clip);
  pipeline::AnalyzeOptions options;
  options.bottom_up = true;
  options.calibrate.calibrate = 1;
  return pipeline::analyze(source, options).model;
}

}  // namespace

TEST_CASE("a model waits for the correction of its rates, which its archive alone suffices for", "[heavy]") {
  auto model = waiting_model();
  REQUIRE(model.correction);
  CHECK(model.correction->rounds == 1);
  const auto archive = to_archive(model);
  auto read = pipeline::clip_model(archive);
  REQUIRE(read.correction);
  CHECK(read.motion == model.motion);
  const auto before = model.motion;
  CHECK(correct_rates(model).size() == 1);
  CHECK(correct_rates(read).size() == 1);
  CHECK(read.motion == model.motion);
  CHECK(model.motion.rates != before.rates);
  auto rest = model.motion;
  rest.rates = before.rates;
  CHECK(rest == before);
  CHECK_FALSE(model.correction);
  CHECK(correct_rates(model).empty());
  CHECK(read.motion == model.motion);
}

TEST_CASE("strokes are drawn of corrected rates, whoever asks", "[heavy]") {
  const auto waiting = waiting_model();
  auto corrected = waiting;
  correct_rates(corrected);
  const pipeline::ClipSynthesisOptions options{.seed = 3, .method = pipeline::SynthesisMethod::diffusion};
  pipeline::ClipSynthesis a(waiting, options), b(corrected, options);
  for (int t = 0; t < 4; ++t) CHECK(same_pixels(a.next(), b.next()));
}

TEST_CASE("a damaged correction is refused") {
  auto archive = to_archive(waiting_model());
  const auto broken = [&](const std::string& field, const nlohmann::json& value) {
    auto changed = archive;
    auto text = nlohmann::json::parse(archive.text);
    text["correction"][field] = value;
    changed.text = text.dump();
    return changed;
  };
  CHECK_THROWS_AS(pipeline::clip_model(broken("rounds", 1000)), core::IoError);
  CHECK_THROWS_AS(pipeline::clip_model(broken("source", "none")), core::IoError);
  CHECK_THROWS_AS(pipeline::clip_model(broken("sketch", {{"spacing", -4}})), core::IoError);
}
