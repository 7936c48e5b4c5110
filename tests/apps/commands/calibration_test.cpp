// SPDX-License-Identifier: Apache-2.0
#include "pipeline/calibration.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "graph/events/events.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const std::vector<std::string> kSmallFire{"analyze", "builtin:fire", "--bottom-up", "--scale", "0.4",
                                          "--range", "20:44",        "-q",          "--json"};

constexpr std::size_t kBirth = static_cast<std::size_t>(graph::EventType::birth),
                      kDeath = static_cast<std::size_t>(graph::EventType::death);

// Deaths a frame and stroke, of the sizes that the clip has.
double deaths(const mcmc::MotionModel& model, const mcmc::EventStatistics& source) {
  double sum = 0, strokes = 0;
  for (std::size_t size = 0; size < mcmc::kSizeClasses; ++size) {
    sum += source.strokes[size] * model.rates.death_by_size[size];
    strokes += source.strokes[size];
  }
  return sum / strokes;
}

}  // namespace

TEST_CASE(
    "an analysis tells what its model is to be calibrated to, and leaves that to the first drawn clip") {
  const TempFolder temp;
  const auto analyze = [&](const std::string& name, const std::vector<std::string>& more) {
    const auto result = run_command(joined(kSmallFire, {"-o", (temp / name).string()}, more));
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return Json::parse(result.out);
  };
  const auto plain = analyze("plain", {"--set", "calibrate.calibrate=0"});
  CHECK(plain["calibration"].is_null());
  CHECK_FALSE(Json::parse(bytes_of(temp / "plain/model/model.json")).contains("correction"));
  const auto told = analyze("told", {"--set", "calibrate.calibrate=2", "--threads", "1"});
  const auto& calibration = told["calibration"];
  CHECK(told["options"]["calibrate"]["calibrate"] == 2);
  CHECK(calibration["rounds"] == 2);
  CHECK(calibration["source"]["patches"] > 10);
  CHECK(calibration["source"]["strokes"] > 1);
  CHECK(calibration["source"]["events"].size() == 6);
  for (const auto& [name, rate] : calibration["source"]["events"].items()) CHECK(rate >= 0);
  // The source is sketched like drawn clips, without lasting patches.
  const auto patches_of = [](const Json& source) { return source["patches"].get<double>(); };
  const double found = plain["sketch"]["patches_per_frame"].get<double>();
  CHECK(patches_of(calibration["source"]) < found + 0.01);
  CHECK(patches_of(calibration["source"]) > 0.8 * found);
  CHECK(bytes_of(temp / "told/motion.jsonl") == bytes_of(temp / "plain/motion.jsonl"));
  const auto again = analyze("again", {"--set", "calibrate.calibrate=2", "--threads", "3"});
  CHECK(again["calibration"] == calibration);
  CHECK(bytes_of(temp / "again/model/model.json") == bytes_of(temp / "told/model/model.json"));
}

TEST_CASE("calibration corrects towards what the source shows") {
  const cv::Size size(120, 90);
  const auto made = made_strokes(10, size.width, size.height, 40);
  const pipeline::ReadingAndDrawing how{{}, {}, {.size = size}};
  pipeline::ClipStrokes strokes(size, 25, how.sketch, how.match);
  for (int t = 0; t < 40; ++t)
    strokes.add(
        pipeline::bytes_to_levels(std::vector<cv::Mat>{made_picture(made, size.width, size.height, t)}), {});
  const auto motion = strokes.motion({});
  const auto source = mcmc::event_statistics(motion, graph::stroke_events(motion));
  const auto fitted = mcmc::fit(motion);
  const auto calibrated = [&](double share) {
    auto wanted = source;
    wanted.events[kBirth] *= share, wanted.events[kDeath] *= share;
    auto model = fitted;
    const auto seen = pipeline::calibrate(model, wanted, how, {1}, 1, {});
    REQUIRE(seen.size() == 1);
    return std::pair(seen.front(), deaths(model.model, source));
  };
  const auto [seen_few, few] = calibrated(0.5);
  const auto [seen_many, many] = calibrated(2);
  CHECK(seen_few.events == seen_many.events);
  CHECK(seen_few.patches > 0);
  CHECK(many > 1.5 * few);
}

TEST_CASE("nothing is calibrated where there is nothing to see") {
  mcmc::FitResult fitted;
  CHECK(pipeline::calibrate(fitted, {}, {}, {3}, 1, {}).empty());
}

TEST_CASE("rounds of calibration out of range are refused in one line") {
  const TempFolder temp;
  const auto out = temp / "out";
  for (const std::string rounds : {"-1", "21"})
    check_one_line(
        {"analyze", "builtin:fire", "-o", out.string(), "-q", "--set", "calibrate.calibrate=" + rounds}, 2,
        {"calibrate.calibrate", rounds, "0", "20"}, out);
  check_one_line({"analyze", "builtin:fire", "-o", out.string(), "-q", "--set", "calibrate.calibrate=few"}, 2,
                 {"calibrate.calibrate", "few"}, out);
}
