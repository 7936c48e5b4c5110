// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "apps/batch/batch_manifest.hpp"
#include "apps/batch/batch_plan.hpp"
#include "core/error.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const std::vector<std::string> kQuick{"--bottom-up"};

/// Two clips in one group, one in another, and a file that is none.
void make_clips(const TempFolder& temp) {
  for (const char* folder : {"clips/wild", "clips/mutant"}) fs::create_directories(temp / folder);
  write_strokes(temp / "clips/wild/a.avi", {96, 72}, 8, 4);
  write_strokes(temp / "clips/wild/b.avi", {96, 72}, 8, 5);
  write_strokes(temp / "clips/mutant/c.avi", {96, 72}, 8, 8);
  std::ofstream(temp / "clips/mutant/broken.avi") << "no video";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::map<std::string, std::string> states(const fs::path& folder) {
  std::map<std::string, std::string> found;
  const Json manifest = json_of(folder / "batch.json");
  for (const auto& run : manifest["runs"]) found[run["run"]] = run["state"];
  return found;
}

}  // namespace

TEST_CASE("a plan names runs by what the clips' paths differ in") {
  const TempFolder temp;
  make_clips(temp);
  const auto names = [&](const std::vector<std::string>& words) {
    std::vector<std::string> found;
    for (const auto& run : apps::plan_runs(words)) found.push_back(run.name);
    return found;
  };
  const std::string clips = (temp / "clips").string();
  CHECK(names({clips}) == std::vector<std::string>{"mutant/broken", "mutant/c", "wild/a", "wild/b"});
  CHECK(names({clips + "/wild/*.avi"}) == std::vector<std::string>{"a", "b"});
  CHECK(names({clips + "/*/?.avi", clips + "/wild/a.avi"}) ==
        std::vector<std::string>{"mutant/c", "wild/a", "wild/b"});
  CHECK(names({"builtin:fire", clips + "/wild/a.avi"}) == std::vector<std::string>{"a", "fire"});
  write_strokes(temp / "clips/wild/a.mp4", {96, 72}, 4, 3);
  CHECK(names({clips + "/wild/a.*"}) == std::vector<std::string>{"a.avi", "a.mp4"});
  write_strokes(temp / "clips/frames", {96, 72}, 4, 3);
  CHECK(names({clips + "/frames", clips + "/wild/b.avi"}) == std::vector<std::string>{"frames", "wild/b"});
  for (const std::string& wrong : {clips + "/none*", clips + "/frames/*.png", std::string("-")})
    CHECK_THROWS_AS(apps::plan_runs({wrong}), core::InputError);
}

TEST_CASE("each TIFF stack of a folder is a clip") {
  const TempFolder temp;
  const std::vector<cv::Mat> pages{noise_frame({16, 12}, CV_8UC1, 1), noise_frame({16, 12}, CV_8UC1, 2)};
  for (const char* folder : {"clips/wild", "clips/mutant", "clips/frames"})
    fs::create_directories(temp / folder);
  for (const char* stack :
       {"clips/wild/a.tif", "clips/wild/b.tif", "clips/mutant/a.TIF", "clips/mutant/m.stk"})
    write_tiff(temp / stack, pages);
  for (const char* frame : {"clips/frames/f1.tif", "clips/frames/f2.tif"})
    write_tiff(temp / frame, {pages[0]});
  const auto names = [&](const std::vector<std::string>& words) {
    std::vector<std::string> found;
    for (const auto& run : apps::plan_runs(words)) found.push_back(run.name);
    return found;
  };
  const std::string clips = (temp / "clips").string();
  CHECK(names({clips}) == std::vector<std::string>{"frames", "mutant/a", "mutant/m", "wild/a", "wild/b"});
  CHECK(names({clips + "/wild", clips + "/mutant"}) ==
        std::vector<std::string>{"mutant/a", "mutant/m", "wild/a", "wild/b"});
  CHECK(names({clips + "/wild/*.tif"}) == std::vector<std::string>{"a", "b"});
  write_tiff(temp / "clips/wild/single.tif", {pages[0]});
  const auto message = message_of<core::InputError>([&] { apps::plan_runs({clips}); });
  CHECK(contains(message, "wild holds TIFF stacks"));
  CHECK(contains(message, "single.tif"));
}

TEST_CASE("a batch analyses clips that can be, says why others cannot, and does nothing twice", "[slow]") {
  const TempFolder temp;
  make_clips(temp);
  const auto runs = temp / "runs";
  const auto batch =
      joined({"runs", "batch", (temp / "clips").string(), "-o", runs.string(), "--jobs", "2"}, kQuick);
  const auto first = run_command(batch);
  INFO(first.err);
  CHECK(first.exit == 1);
  CHECK(contains(first.err, "1 of 4 clips failed"));
  CHECK(contains(first.err, "broken.avi"));
  CHECK(states(runs) ==
        std::map<std::string, std::string>{
            {"mutant/broken", "failed"}, {"mutant/c", "done"}, {"wild/a", "done"}, {"wild/b", "done"}});
  CHECK_FALSE(fs::exists(runs / "mutant/broken"));
  const auto kept = fs::last_write_time(runs / "wild/a/summary.json");

  write_strokes(temp / "clips/mutant/broken.avi", {96, 72}, 8, 6);
  const auto second = run_command(batch);
  INFO(second.err);
  CHECK(second.exit == 0);
  CHECK(contains(second.err, "3 of 4 clips were done before"));
  CHECK(fs::last_write_time(runs / "wild/a/summary.json") == kept);
  CHECK(states(runs)["mutant/broken"] == "done");

  // A run is that of analyze with the same options.
  const auto alone = temp / "alone";
  REQUIRE(run_command(
              joined({"analyze", (temp / "clips/wild/a.avi").string(), "-o", alone.string(), "-q"}, kQuick))
              .exit == 0);
  for (const char* name : {"events.json", "motion.jsonl", "model/model.json"})
    CHECK(bytes_of(alone / name) == bytes_of(runs / "wild/a" / name));

  const auto other = run_command(joined(batch, {"--scale", "0.5", "--json", "-q"}));
  INFO(other.err);
  CHECK(other.exit == 0);
  CHECK(Json::parse(other.out)["runs"].size() == 4);
  CHECK(json_of(runs / "wild/a/summary.json")["clip"]["width"] == 48);
}

TEST_CASE("a batch that is stopped keeps what is done, and goes on") {
  const TempFolder temp;
  make_clips(temp);
  fs::remove(temp / "clips/mutant/broken.avi");
  const auto runs = temp / "runs";
  const auto batch = joined({"runs", "batch", (temp / "clips").string(), "-o", runs.string()}, kQuick);
  for (const int signal : {SIGTERM, SIGKILL}) {
    CommandOptions options;
    options.signal = signal;
    options.interrupt_if = [&] {
      return fs::exists(runs / "batch.json") && contains(bytes_of(runs / "batch.json"), "\"done\"");
    };
    const auto stopped = run_command(batch, options);
    INFO(stopped.err);
    CHECK(stopped.exit == (signal == SIGKILL ? 128 + SIGKILL : 130));
    if (signal == SIGTERM) CHECK(contains(stopped.err, "the same command goes on"));
  }
  const auto whole = run_command(batch);
  INFO(whole.err);
  CHECK(whole.exit == 0);
  CHECK(contains(whole.err, "were done before"));
  for (const auto& [run, state] : states(runs)) CHECK(state == "done");
}

TEST_CASE("what a batch is not asked rightly is told in one line, and nothing is made") {
  const TempFolder temp;
  make_clips(temp);
  const auto clips = (temp / "clips").string(), out = (temp / "runs").string();
  check_one_line({"runs", "batch", clips + "/none*.avi", "-o", out, "-q"}, 2, {"none*.avi", "fits no"}, out);
  check_one_line({"runs", "batch", clips, "-o", out, "-q", "--jobs", "0"}, 2, {"--jobs", "0", "1"}, out);
  check_one_line({"runs", "batch", clips, "-o", out, "-q", "--set", "sketch.spacing=1"}, 2,
                 {"sketch.spacing"}, out);
  fs::create_directory(temp / "runs");
  std::ofstream(temp / "runs/batch.json") << "[]";
  check_one_line({"runs", "batch", clips, "-o", out, "-q"}, 1, {"batch.json"});
  fs::remove(temp / "runs/batch.json");
  const apps::BatchLock lock(temp / "runs");
  check_one_line({"runs", "batch", clips, "-o", out, "-q"}, 1, {"another", "runs"});
}

TEST_CASE("gathered runs make one table, a report, and say what groups differ in") {
  const TempFolder temp;
  make_clips(temp);
  const auto runs = temp / "runs";
  run_command(
      joined({"runs", "batch", (temp / "clips").string(), "-o", runs.string(), "-q", "--fps", "10"}, kQuick));
  const auto gathered = run_command({"runs", "gather", runs.string(), "--json"});
  INFO(gathered.err);
  REQUIRE(gathered.exit == 0);
  const Json summary = Json::parse(gathered.out);
  CHECK(summary["gathered"]["per"] == "second");
  CHECK(summary["gathered"]["runs"].size() == 3);
  CHECK(summary["gathered"]["tests"].size() == 7);
  CHECK(summary["gathered"]["failed"].size() == 1);
  const auto lines = lines_of(bytes_of(runs / "gathered/table.csv"));
  CHECK(lines.size() == 1 + 7 * (3 + 2));
  CHECK(lines.front().starts_with("of,group,run,clip,type,count"));
  double sum = 0, group = 0;
  for (const auto& run : summary["gathered"]["runs"])
    if (run["group"] == "wild") sum += run["rates"]["all"]["count"].get<double>();
  for (const auto& one : summary["gathered"]["groups"])
    if (one["group"] == "wild") group = one["rates"]["all"]["count"].get<double>();
  CHECK(sum == group);
  CHECK(json_of(runs / "wild/a/summary.json")["events"]["total"] ==
        summary["gathered"]["runs"][1]["rates"]["all"]["count"]);
  const auto page = bytes_of(runs / "gathered/report.html");
  CHECK(contains(page, "../wild/a/report.html"));
  CHECK(contains(page, "broken"));
  // Gathered once more, the result is no run itself.
  const auto again = run_command({"runs", "gather", runs.string(), "--json", "-q"});
  CHECK(Json::parse(again.out)["gathered"] == summary["gathered"]);

  std::ofstream(temp / "groups.csv") << "run,group\nwild/a,x\nwild/b,\"y\"\n";
  const auto groups = run_command({"runs", "gather", runs.string(), "-o", (temp / "g").string(), "--groups",
                                   (temp / "groups.csv").string(), "--json", "-q"});
  INFO(groups.err);
  REQUIRE(groups.exit == 0);
  CHECK(Json::parse(groups.out)["gathered"]["groups"].size() == 3);
  std::ofstream(temp / "groups.csv") << "run,group\nwild/nobody,x\n";
  check_one_line({"runs", "gather", runs.string(), "-o", (temp / "h").string(), "--groups",
                  (temp / "groups.csv").string(), "-q"},
                 1, {"wild/nobody"}, temp / "h");
  check_one_line({"runs", "gather", (temp / "clips").string(), "-q"}, 1, {"holds no run"},
                 temp / "clips/gathered");
  check_one_line({"runs", "gather", (temp / "none").string(), "-q"}, 1, {"none", "no folder"});
}
