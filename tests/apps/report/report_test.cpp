// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report.hpp"

#include <regex>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/report/report_data.hpp"
#include "tests/apps/report/page_data.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_models.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

const OrderedJson kSummary = {
    {"seed", 1}, {"options", {{"sketch", {{"scales", 5}}}}}, {"warnings", OrderedJson::array()}};

ReportInput input_for(const graph::MotionGraph& motion, std::span<const graph::Event> events) {
  ReportInput input;
  input.clip = "clips/fire.avi";
  input.command_line = "emberfold analyze clips/fire.avi -o out";
  input.version = "0.0.0";
  input.motion = &motion;
  input.events = events;
  return input;
}

std::vector<graph::Event> many_events(std::size_t number, int frames, int width, int height) {
  core::Rng rng(4);
  std::vector<graph::Event> events;
  for (std::size_t i = 0; i < number; ++i) {
    graph::Event e;
    e.frame = 1 + static_cast<int>(i * static_cast<std::size_t>(frames - 1) / number);
    e.type = static_cast<graph::EventType>(rng.below(6));
    e.position = {rng.uniform(0, width), rng.uniform(0, height)};
    e.probability = rng.uniform(0.5, 1);
    for (int k = 0; k < 3; ++k) e.before.push_back({rng.bits()}), e.after.push_back({rng.bits()});
    events.push_back(e);
  }
  return events;
}

}  // namespace

TEST_CASE("the report is one page that asks for nothing else, and its data are what went in") {
  const auto strokes = made_strokes(9, 160, 120, 30);
  const auto motion = made_motion(strokes, 160, 120, 30);
  const auto events = graph::stroke_events(motion);
  REQUIRE(events.size() > 5);
  auto input = input_for(motion, events);
  const Still still = make_still(made_picture(strokes, 160, 120, 15), 960, 50'000);
  input.stills.push_back({15, still, still, still, 31.5, 0.2});
  input.trajectories = still;
  input.event_frames.push_back({events[2].frame, still});
  input.matches.push_back({events[2].frame, still});
  const std::string page = make_report(input, kSummary);

  CHECK_FALSE(
      std::regex_search(page, std::regex("(src|href|action|data|poster)\\s*=\\s*[\"']?(https?:)?//")));
  CHECK_FALSE(
      std::regex_search(page, std::regex("@import|url\\(|fetch\\(|XMLHttpRequest|import\\(|WebSocket")));
  CHECK(page.find("<link rel=\"stylesheet\"") == std::string::npos);
  CHECK(page.find("{{") == std::string::npos);
  CHECK(count(page, "<script") == 2);
  CHECK(count(page, "</script>") == 2);

  const OrderedJson data = data_of(page);
  CHECK(data["clip"]["frames"] == 30);
  REQUIRE(data["events"]["frame"].size() == events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    CHECK(data["events"]["frame"][i] == events[i].frame);
    const auto type = data["events"]["type"][i].get<std::size_t>();
    CHECK(data["classes"][type]["name"] == graph::name(events[i].type));
    CHECK(std::abs(data["events"]["x"][i].get<double>() - events[i].position.x) <= 0.05001);
  }
  CHECK(data["stills"][0]["uri"].get<std::string>().starts_with("data:image/jpeg;base64,/9j/"));
  CHECK(data["space_time"]["uri"].get<std::string>().starts_with("data:image/jpeg;base64,/9j/"));
  CHECK(data["summary"]["seed"] == 1);
}

TEST_CASE("no text of the user becomes markup or ends the script") {
  const auto motion = made_motion(made_strokes(2, 60, 60, 4), 60, 60, 4);
  const std::string evil = "a</script><script>alert(1)</script><!--&quot;\"'{{script}}\xff\xc3\x28.avi";
  auto input = input_for(motion, {});
  input.clip = evil;
  input.command_line = "emberfold analyze '" + evil + "' -o out";
  OrderedJson summary = kSummary;
  summary["warnings"] = {evil};
  const std::string page = make_report(input, summary);
  CHECK(count(page, "<script") == 2);
  CHECK(count(page, "</script>") == 2);
  CHECK(page.find("<!--") == std::string::npos);
  CHECK(page.find("alert(1)<") == std::string::npos);
  const OrderedJson data = data_of(page);  // parses in spite of the bytes that are no UTF-8
  CHECK(data["command"].get<std::string>().starts_with("emberfold analyze 'a</script><script>alert(1)"));
  CHECK(data["command"].get<std::string>().find("{{script}}") != std::string::npos);
  CHECK(escape_html("<a href=\"x\">&'") == "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST_CASE("a clip without strokes or events has a report too") {
  graph::MotionGraph motion;
  motion.sketch.width = motion.sketch.height = 2;
  motion.sketch.frames.resize(3);
  motion.links.resize(3);
  const OrderedJson data = data_of(make_report(input_for(motion, {}), kSummary));
  CHECK(data["events"]["total"] == 0);
  CHECK(data["strokes"].empty());
  CHECK(data["series"]["patches"] == OrderedJson({0.0, 0.0, 0.0}));
}

TEST_CASE("the report stays below its limit for a long, large, crowded clip of pure noise") {
  constexpr int kWidth = 1280, kHeight = 720, kFrames = 743;
  const auto motion = made_motion(made_strokes(160, kWidth, kHeight, kFrames, 3), kWidth, kHeight, kFrames);
  const auto events = many_events(60'000, kFrames, kWidth, kHeight);
  auto input = input_for(motion, events);
  cv::Mat noise = noise_frame({320, 180}, CV_8UC3, 1);
  cv::resize(noise, noise, {kWidth, kHeight}, 0, 0, cv::INTER_NEAREST);
  const auto of = [&](int side, std::size_t bytes) { return make_still(noise, side, bytes); };
  const Still layer = of(960, kStillBytes / (3 * kStills)), small = of(720, kEventFrameBytes / kEventFrames),
              pair = of(1800, kMatchBytes / kMatches);
  for (std::size_t i = 0; i < kStills; ++i)
    input.stills.push_back({static_cast<int>(i), layer, layer, layer, 30, 0.2});
  for (std::size_t i = 0; i < kEventFrames; ++i)
    input.event_frames.push_back({static_cast<int>(8 * i), small});
  input.trajectories = of(1400, kTrajectoryBytes);
  for (std::size_t i = 0; i < kMatches; ++i) input.matches.push_back({static_cast<int>(8 * i + 1), pair});
  // the budget is meant to be used, or the test would show nothing
  CHECK(3 * kStills * layer.jpeg.size() + kEventFrames * small.jpeg.size() + kMatches * pair.jpeg.size() >
        2'500'000);
  const auto model = made_model(kWidth, kHeight, 8);
  input.model = &model;
  input.eigenvalues.assign(700, {0.123456, 0.654321});
  input.clips = ReportClips{{"a", "b", "c"}, std::vector<unsigned char>(kClipBytes, 77), 400, 226, 250, 25};
  mcmc::SamplerRun sampled;
  sampled.chains = 8, sampled.burn_in = 1000;
  sampled.traces.assign(40, {"some number", std::vector(8, std::vector<double>(5000, -123.456))});
  input.sampled = &sampled;
  input.all_events = events;
  OrderedJson summary = kSummary;
  summary["per_frame"] = {{"patches", std::vector<int>(200'000, 1234)}};
  const std::string page = make_report(input, summary);
  CHECK(page.size() < kReportBytes);
  const OrderedJson data = data_of(page);
  CHECK(data["events"]["total"] == 60'000);
  const auto every = data["events"]["every"].get<std::size_t>();
  CHECK(every > 1);
  CHECK(data["events"]["frame"].size() == (60'000 + every - 1) / every);
  CHECK(data["frames"].size() == kEventFrames);
}

TEST_CASE("series of a very long clip are means that keep the whole") {
  graph::MotionGraph motion;
  motion.sketch.width = motion.sketch.height = 4;
  motion.sketch.frames.resize(10'000);
  motion.links.resize(10'000);
  const auto events = many_events(5000, 10'000, 4, 4);
  const OrderedJson series = report_series(motion, events);
  const auto step = series["step"].get<std::size_t>();
  CHECK(series["strokes"].size() == (10'000 + step - 1) / step);
  CHECK(series["strokes"].size() <= 1500);
  double total = 0;
  for (const auto& list : series["events"])
    for (const auto& value : list) total += value.get<double>() * static_cast<double>(step);
  CHECK_THAT(total, Catch::Matchers::WithinRel(5000.0, 0.02));
}

TEST_CASE("paths follow strokes and patches frame by frame") {
  const auto strokes = made_strokes(1, 200, 150, 20, 2);
  REQUIRE(strokes[0].comes_apart);
  const auto motion = made_motion(strokes, 200, 150, 20);
  const OrderedJson patches = report_patch_paths(motion);
  REQUIRE(patches.size() == static_cast<std::size_t>(strokes[0].patches));
  std::vector<int> times_found(patches.size());
  for (const auto& path : patches) {
    CHECK(path[0] == strokes[0].first);
    REQUIRE((path.size() - 1) / 2 == static_cast<std::size_t>(strokes[0].last - strokes[0].first + 1));
    for (std::size_t k = 0; k < patches.size(); ++k) {
      bool everywhere = true;
      for (std::size_t t = 0; 2 * t + 2 < path.size(); ++t) {
        const auto at =
            made_patch(strokes[0], strokes[0].first + static_cast<int>(t), static_cast<int>(k)).position;
        everywhere = everywhere && std::abs(path[2 * t + 1].get<double>() - at.x) <= 0.05001 &&
                     std::abs(path[2 * t + 2].get<double>() - at.y) <= 0.05001;
      }
      times_found[k] += everywhere ? 1 : 0;
    }
  }
  CHECK(times_found == std::vector<int>(patches.size(), 1));
  // whole, then in two: three strokes
  CHECK(report_stroke_paths(motion).size() == 3);
}
