// SPDX-License-Identifier: Apache-2.0
#include "pipeline/readings.hpp"

#include <algorithm>
#include <cmath>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/events.hpp"
#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;

namespace {

/// Bright lines that sway on grey, one of them there from frame 6 on, another one faint; colour or grey.
core::Clip lines(int frames, int type = CV_8UC3) {
  core::Clip clip;
  clip.info.width = 96, clip.info.height = 80, clip.info.channels = CV_MAT_CN(type);
  clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(80, 96, type, cv::Scalar::all(90));
    const int shift = static_cast<int>(std::lround(3 * std::sin(0.4 * t)));
    cv::line(frame, {20 + shift, 8}, {24 + shift, 72}, cv::Scalar::all(200), 3);
    if (t >= 6) cv::line(frame, {50 + shift, 10}, {48 + shift, 66}, cv::Scalar::all(190), 3);
    cv::line(frame, {76 + shift, 8}, {78 + shift, 72}, cv::Scalar::all(97), 3);
    cv::GaussianBlur(frame, frame, {}, 0.8);
    clip.frames.push_back(frame);
  }
  return clip;
}

pipeline::StartOptions with(int chains) {
  pipeline::StartOptions options;
  options.chains = chains;
  return options;
}

std::vector<graph::MotionGraph> starts(const core::Clip& clip, const pipeline::StartOptions& options,
                                       std::uint64_t seed = 1) {
  core::ClipSource source(clip);
  return pipeline::match_starts(pipeline::sketch_starts(source, {}, options, seed, {}), {}, options, {});
}

}  // namespace

TEST_CASE("at least half of the starts read the clip as it is") {
  for (const int chains : {1, 2, 3, 4, 5, 6, 7, 8, 13}) {
    const auto made = pipeline::readings(with(chains));
    REQUIRE(made.size() == static_cast<std::size_t>(chains));
    std::size_t copies = 0;
    for (const pipeline::StartReading& copy : made)
      if (copy) CHECK(*copy == copies++);
    CHECK(copies == made.size() / 2);
    CHECK_FALSE(made[0].has_value());
  }
}

TEST_CASE("chains that read alike start alike") {
  const auto made = starts(lines(8), with(6));
  REQUIRE(made.size() == 6);
  CHECK(made[2] == made[0]);
  CHECK(made[4] == made[0]);
  CHECK_FALSE(made[1] == made[0]);
  CHECK_FALSE(made[1].sketch == made[3].sketch);
}

TEST_CASE("the first start is the clip's own sketch, matched") {
  const core::Clip clip = lines(12);
  const auto made = starts(clip, with(3));
  REQUIRE(made.size() == 3);
  graph::SketchSequence own;
  own.width = 96, own.height = 80, own.fps = clip.info.fps;
  for (const auto& frame : clip.frames) own.append(sketch::extract(core::to_levels(frame, clip.info), {}));
  CHECK(made[0] == graph::match(own, {}));
  for (const auto& motion : made) {
    CHECK_NOTHROW(graph::validate(motion));
    CHECK(motion == graph::identify(motion));
    CHECK(motion.sketch.frames.size() == 12);
    // The line that comes is born in every reading.
    const auto events = graph::stroke_events(motion);
    CHECK(std::ranges::any_of(events, [](const auto& e) {
      return e.type == graph::EventType::birth && e.frame == 6 && graph::distance(e.position, {49, 38}) < 8;
    }));
  }
}

TEST_CASE("the start of a clip run backwards is its start run backwards") {
  core::Clip clip = lines(12);
  const auto there = starts(clip, with(1));
  std::ranges::reverse(clip.frames);
  CHECK(graph::reverse_time(starts(clip, with(1))[0]) == there[0]);
}

TEST_CASE("copies differ from the clip and each other and depend on seed and place alone") {
  const core::Clip clip = lines(8), shorter = lines(5);
  core::ClipSource source(clip), part(shorter);
  const auto sketches = pipeline::sketch_starts(source, {}, with(7), 7, {});
  REQUIRE(sketches.perturbed.size() == 3);
  REQUIRE(sketches.clip.grounds.size() == 8);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK_FALSE(sketches.perturbed[k] == sketches.clip.sketch);
    CHECK_FALSE(sketches.perturbed[k] == sketches.perturbed[(k + 1) % 3]);
  }
  const auto again = pipeline::sketch_starts(source, {}, with(7), 7, {});
  CHECK(again.perturbed == sketches.perturbed);
  // Neither the number of chains nor that of frames changes what a copy is.
  const auto fewer = pipeline::sketch_starts(part, {}, with(3), 7, {});
  REQUIRE(fewer.perturbed.size() == 1);
  for (std::size_t t = 0; t < 5; ++t) CHECK(fewer.perturbed[0].frames[t] == sketches.perturbed[0].frames[t]);
  const auto other = pipeline::sketch_starts(source, {}, with(3), 8, {});
  CHECK_FALSE(other.perturbed[0] == sketches.perturbed[0]);
  CHECK(other.clip.sketch == sketches.clip.sketch);
}

TEST_CASE("the same starts on one thread and on several") {
  const core::Clip clip = lines(20);
  std::vector<graph::MotionGraph> one, several;
  {
    const core::ThreadLimit limit(1);
    one = starts(clip, with(4));
  }
  {
    const core::ThreadLimit limit(4);
    several = starts(clip, with(4));
  }
  CHECK(one == several);
}

TEST_CASE("noise in luma is as strong in colour as in grey") {
  for (const int type : {CV_32FC1, CV_32FC3})
    for (const double sd : {0.5, 2.0, 15.0}) {
      const cv::Mat flat(200, 200, type, cv::Scalar::all(90));
      const cv::Mat noise = core::luma(pipeline::add_noise(flat, sd, 3, 0, 0)) - core::luma(flat);
      cv::Scalar mean, spread;
      cv::meanStdDev(noise, mean, spread);
      CHECK(std::abs(mean[0]) < 0.025 * sd);  // five SD of a mean of 40 000
      CHECK(std::abs(spread[0] - sd) < 0.02 * sd);
    }
}

TEST_CASE("without noise a copy is the frame") {
  cv::Mat3f frame(9, 9);
  cv::RNG(4).fill(frame, cv::RNG::UNIFORM, 0, 255);
  const cv::Mat copy = pipeline::add_noise(frame, 0, 1, 2, 3);
  CHECK(cv::norm(copy, frame, cv::NORM_INF) == 0);
}

TEST_CASE("starts: options out of range are named") {
  const auto complaint = [](const pipeline::StartOptions& options) {
    return test::message_of<core::InputError>([&] { options.validate(); });
  };
  CHECK(complaint({}).empty());
  CHECK(test::contains(complaint(with(0)), "chains is 0"));
  CHECK(test::contains(complaint(with(65)), "chains is 65"));
  const core::Clip clip = lines(2);
  core::ClipSource source(clip);
  auto sketches = pipeline::sketch_starts(source, {}, with(3), 1, {});
  const auto mismatch =
      test::message_of<core::InputError>([&] { pipeline::match_starts(sketches, {}, with(4), {}); });
  CHECK(test::contains(mismatch, "1 copies in noise for 4 chains"));
}

TEST_CASE("starts can be stopped and tell how far they are") {
  const core::Clip clip = lines(6);
  core::ClipSource source(clip);
  std::stop_source stop;
  double last = 0;
  bool rises = true;
  const core::Context reporting(stop.get_token(), [&](std::string_view stage, double share) {
    if (stage != "match") return;
    rises = rises && share >= last;
    last = share;
    if (share > 0) stop.request_stop();
  });
  const auto sketches = pipeline::sketch_starts(source, {}, with(6), 1, {});
  CHECK_THROWS_AS(pipeline::match_starts(sketches, {}, with(6), reporting), core::Cancelled);
  CHECK(rises);
  CHECK(last > 0);
  CHECK_THROWS_AS(pipeline::sketch_starts(source, {}, with(6), 1, reporting), core::Cancelled);
}
