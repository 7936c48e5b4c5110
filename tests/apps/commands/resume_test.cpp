// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <string>

#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// All that a run leaves but for times, paths and the stages themselves.
void check_same_run(const fs::path& a, const fs::path& b) {
  for (const char* name : {"events.json", "events_all.json", "events.csv", "motion.jsonl", "sketch.jsonl",
                           "strokes.csv", "curves.csv", "model/model.json", "overlay.mp4"}) {
    INFO(name);
    CHECK(bytes_of(a / name) == bytes_of(b / name));
  }
  const Json one = summary_of(a), other = summary_of(b);
  for (const char* part : {"sketch", "motion", "events", "model", "rates", "strokes", "per_frame"})
    CHECK(one[part] == other[part]);
}

}  // namespace

TEST_CASE("a run that was stopped, even killed, goes on where it was and ends the same", "[slow]") {
  const TempFolder temp;
  // So long that the sketch goes on well after its first two blocks.
  const auto clip = write_strokes(temp / "clip.avi", {200, 150}, 120, 9);
  const auto analyze = [&](const std::string& out) {
    return std::vector<std::string>{"analyze", clip, "-o", (temp / out).string(), "--threads", "1"};
  };
  REQUIRE(run_command(analyze("whole")).exit == 0);
  const auto run = temp / "run";
  const auto stop_when = [&](const fs::path& there, int signal) {
    CommandOptions options;
    options.signal = signal;
    options.interrupt_if = [&, there] { return fs::exists(there); };
    return run_command(analyze("run"), options);
  };
  const auto in_sketch = stop_when(run / "stages/sketch_parts/0", SIGKILL);
  CHECK(in_sketch.exit == 128 + SIGKILL);
  const auto part = fs::last_write_time(run / "stages/sketch_parts/0/columns.json");
  const auto again = stop_when(run / "stages/sketch_parts/1", SIGTERM);
  INFO(again.err);
  CHECK(again.exit == 130);
  CHECK(contains(again.err, "the same command goes on"));
  CHECK(fs::last_write_time(run / "stages/sketch_parts/0/columns.json") == part);
  const auto after_events = stop_when(run / "events.json", SIGINT);
  INFO(after_events.err);
  CHECK(after_events.exit == 130);
  CHECK(bytes_of(run / "events.json") == bytes_of(temp / "whole/events.json"));
  CHECK_FALSE(fs::exists(run / "report.html"));
  const auto last = run_command(analyze("run"));
  INFO(last.err);
  CHECK(last.exit == 0);
  CHECK_FALSE(contains(last.err, "emberfold: match"));
  check_same_run(run, temp / "whole");
  CHECK(entries(run) == entries(temp / "whole"));
}

TEST_CASE("a run that is done is not done again, and other options make what depends on them") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {120, 90}, 10, 8);
  const auto run = temp / "run";
  const auto analyze = [&](const std::vector<std::string>& more) {
    return run_command(joined({"analyze", clip, "-o", run.string(), "--json"}, more));
  };
  const auto first = analyze({});
  INFO(first.err);
  REQUIRE(first.exit == 0);
  const auto page = fs::last_write_time(run / "report.html");
  const auto second = analyze({});
  CHECK(second.exit == 0);
  CHECK(second.out == first.out);
  CHECK(fs::last_write_time(run / "report.html") == page);
  const auto told = [](const CommandResult& result, const char* stage) {
    return contains(result.err, std::string("emberfold: ") + stage + "\n");
  };
  CHECK(told(first, "sketch"));
  CHECK_FALSE(told(second, "sketch"));

  fs::remove(run / "strokes.csv");
  fs::remove_all(run / "model");
  CHECK(analyze({}).exit == 0);
  CHECK(fs::exists(run / "strokes.csv"));
  CHECK(fs::exists(run / "model/model.json"));

  const auto more = analyze({"--reconstruction"});
  CHECK(more.exit == 0);
  CHECK(fs::exists(run / "reconstruction.avi"));
  CHECK_FALSE(told(more, "sketch"));
  CHECK_FALSE(told(more, "match"));
  const auto other_match = analyze({"--set", "match.flicker=0"});
  CHECK(other_match.exit == 0);
  CHECK_FALSE(told(other_match, "sketch"));
  CHECK(told(other_match, "match"));
  const auto fresh = temp / "fresh";
  REQUIRE(run_command({"analyze", clip, "-o", fresh.string(), "--set", "match.flicker=0", "-q"}).exit == 0);
  check_same_run(run, fresh);
  write_strokes(temp / "clip.avi", {120, 90}, 10, 5);  // the clip itself is another now
  CHECK(told(analyze({"--set", "match.flicker=0"}), "sketch"));

  fs::resize_file(run / "stages/sketch/numbers.npy", 200);
  CHECK(told(analyze({}), "sketch"));
}

TEST_CASE("the least probability decides what is reported, and the clip is not read again for it") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {120, 90}, 24, 5);
  const auto run = temp / "run";
  const auto analyze = [&](const char* least) {
    return run_command({"analyze", clip, "-o", run.string(), "--least-probability", least});
  };
  REQUIRE(analyze("0.5").exit == 0);
  const auto events = [&](const char* name) { return Json::parse(bytes_of(run / name))["events"]; };
  const Json all = events("events_all.json"), expected = summary_of(run)["events"]["expected"];
  double sum = 0, classes = 0;
  for (const Json& e : all) sum += e["probability"].get<double>();
  for (const auto& [name, of_class] : expected["classes"].items()) classes += of_class.get<double>();
  REQUIRE(sum > 0);
  CHECK(expected["of"] == all.size());
  CHECK_THAT(expected["total"].get<double>(), WithinAbs(sum, 0.051));
  CHECK_THAT(classes, WithinAbs(sum, 0.3));  // rounded to tenths
  for (const char* least : {"0", "0.98", "1"}) {
    const auto again = analyze(least);
    INFO(least << ": " << again.err);
    REQUIRE(again.exit == 0);
    CHECK_FALSE(contains(again.err, "emberfold: match\n"));
    const Json reported = events("events.json");
    CHECK(reported.size() == static_cast<std::size_t>(std::ranges::count_if(all, [&](const Json& e) {
            return e["probability"].get<double>() >= std::stod(least);
          })));
  }
  check_one_line({"analyze", clip, "-o", (temp / "no").string(), "--least-probability", "1.5", "-q"}, 2,
                 {"--least-probability is 1.5", "0 to 1"}, temp / "no");
}

TEST_CASE("drawing from a run does not change its model") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {120, 90}, 12, 8);
  REQUIRE(run_command({"analyze", clip, "-o", (temp / "run").string(), "-q", "--bottom-up"}).exit == 0);
  const auto model = temp / "run/model";
  const auto before = bytes_of(model / "model.json");
  const auto draw = [&](const char* out) {
    return run_command(
        {"synth", model.string(), "-o", (temp / out).string(), "--frames", "4", "--method", "diffusion"});
  };
  const auto first = draw("a"), second = draw("b");
  REQUIRE(first.exit == 0);
  REQUIRE(second.exit == 0);
  CHECK(bytes_of(temp / "a/frame_00003.png") == bytes_of(temp / "b/frame_00003.png"));
  CHECK(bytes_of(model / "model.json") == before);
}

TEST_CASE("events that are weighed end with a whole run, in a new folder and over another one") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {64, 48}, 8, 9);
  for (const char* way : {"normal", "draft", "normal"}) {
    const auto ended =
        run_command({"analyze", clip, "-o", (temp / "run").string(), "--no-edges", "--quality", way});
    INFO(way << ": " << ended.err);
    CHECK(ended.exit == 0);
    CHECK(fs::exists(temp / "run/report.html"));
    CHECK(summary_of(temp / "run").contains("sampler") == (way != std::string("draft")));
  }
}

TEST_CASE("a run of which only the events are there is an earlier result") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {64, 48}, 8, 9);
  const std::vector<std::string> words = {"analyze", clip, "-o", (temp / "run").string(), "--no-edges"};
  CommandOptions options;
  options.signal = SIGKILL;
  options.interrupt_if = [&] { return fs::exists(temp / "run/stages/run/columns.json"); };
  static_cast<void>(run_command(words, options));
  fs::remove_all(temp / "run/stages/motion"), fs::remove_all(temp / "run/stages/model");
  fs::remove(temp / "run/summary.json");
  REQUIRE(fs::exists(temp / "run/events.json"));
  const auto again = run_command(words);
  INFO(again.err);
  CHECK(again.exit == 0);
}
