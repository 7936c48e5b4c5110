// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "graph/events/events.hpp"
#include "graph/exporting/stroke_tree.hpp"
#include "graph/exporting/tracking_files.hpp"
#include "graph/io/motion_io.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct ExportedRun {
  TempFolder temp;
  graph::MotionGraph motion;
  std::vector<graph::Event> events;

  ExportedRun() {
    const auto clip = write_strokes(temp / "clip.avi", {160, 120}, 14, 9);
    REQUIRE(run_command({"analyze", clip, "-o", (temp / "run").string(), "-q", "--bottom-up", "--fps", "10",
                         "--pixel-size", "2um"})
                .exit == 0);
    std::ifstream motion_file(temp / "run/motion.jsonl"), events_file(temp / "run/events.json");
    motion = graph::read_motion(motion_file, "motion.jsonl");
    events = graph::read_events(events_file, "events.json");
  }
};

}  // namespace

TEST_CASE("a run is exported as tables, GEFF, TrackMate and GraphML, alike in what they hold") {
  const ExportedRun made;
  const auto run = (made.temp / "run").string(), out = (made.temp / "out").string();
  const auto result = run_command(
      {"export", run, "--jsonl", "--csv", "--geff", "--trackmate", "--graphml", "-o", out, "--json"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  const Json told = Json::parse(result.out);
  for (const auto& file : told["files"]) CHECK(fs::exists(file.get<std::string>()));
  for (const char* name : {"motion.jsonl", "events.csv", "strokes.csv", "trajectories.csv"})
    CHECK(bytes_of(made.temp / "out" / name) == bytes_of(made.temp / "run" / name));

  const auto tree = graph::make_stroke_tree(made.motion, made.events);
  REQUIRE(tree.rows.size() > 30);
  const auto lines = bytes_of(made.temp / "out/strokes.csv");
  CHECK(static_cast<std::size_t>(std::ranges::count(lines, '\n')) == tree.rows.size() + 1);
  const auto branches = static_cast<std::size_t>(
      std::ranges::count_if(tree.links, [](const auto& link) { return !link.event.empty(); }));
  CHECK(branches > 2);

  const Json about = Json::parse(bytes_of(made.temp / "out/run.geff/.zattrs"))["geff"];
  CHECK(about["directed"] == true);
  CHECK(about["axes"][0]["unit"] == "frame");
  CHECK(about["axes"][0]["scale"] == 0.1);
  CHECK(about["axes"][0]["scaled_unit"] == "second");
  CHECK(about["axes"][1]["unit"] == "micrometer");
  const Json ids = Json::parse(bytes_of(made.temp / "out/run.geff/nodes/ids/.zarray")),
             edges = Json::parse(bytes_of(made.temp / "out/run.geff/edges/ids/.zarray"));
  CHECK(ids["shape"] == Json({tree.rows.size()}));
  CHECK(edges["shape"] == Json({tree.links.size(), 2}));
  CHECK(fs::file_size(made.temp / "out/run.geff/edges/ids/0.0") == 16 * tree.links.size());
  CHECK(fs::file_size(made.temp / "out/run.geff/nodes/props/x/values/0") == 8 * tree.rows.size());

  const auto spots = bytes_of(made.temp / "out/trackmate.xml");
  CHECK(count(spots, "<Spot ") == tree.rows.size());
  CHECK(count(spots, "<Edge ") == tree.links.size());
  CHECK(contains(spots, "timeinterval=\"0.1\""));
  const auto genealogy = bytes_of(made.temp / "out/genealogy.graphml");
  std::set<std::uint32_t> strokes;
  for (const auto& row : tree.rows) strokes.insert(row.stroke);
  CHECK(count(genealogy, "<node ") == strokes.size());
  CHECK(count(genealogy, "<edge ") == branches);

  REQUIRE(run_command({"export", run, "--geff", "-q"}).exit == 0);
  CHECK(fs::exists(made.temp / "run/run.geff/.zattrs"));
}

TEST_CASE("an export that cannot be is refused in one line") {
  const TempFolder temp;
  check_one_line({"export", temp.path().string(), "--csv", "-q"}, 1, {"no finished run"});
  check_one_line({"export", temp.path().string(), "-q"}, 2, {"--geff"});
  check_one_line({"export", (temp / "none").string(), "--geff", "-q"}, 1, {"none"});
}

TEST_CASE("graphs are left out of a run that is told so, and come with the same command told otherwise") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {160, 120}, 14, 9), run = (temp / "run").string();
  const auto analyze = [&](const char* how) {
    return run_command({"analyze", clip, "-o", run, "-q", "--bottom-up", "--json", how});
  };
  const auto with = Json::parse(analyze("--jsonl").out);
  CHECK(with["files"].contains("motion.jsonl"));
  const auto motion = bytes_of(temp / "run/motion.jsonl"), sketch = bytes_of(temp / "run/sketch.jsonl");
  const auto events = bytes_of(temp / "run/events.json");
  const auto without = Json::parse(analyze("--no-jsonl").out);
  CHECK_FALSE(without["files"].contains("motion.jsonl"));
  CHECK_FALSE(fs::exists(temp / "run/motion.jsonl"));
  CHECK_FALSE(fs::exists(temp / "run/sketch.jsonl"));
  CHECK(bytes_of(temp / "run/events.json") == events);
  REQUIRE(analyze("--jsonl").exit == 0);
  CHECK(bytes_of(temp / "run/motion.jsonl") == motion);
  CHECK(bytes_of(temp / "run/sketch.jsonl") == sketch);
}

TEST_CASE("export makes the graphs of a run that left them out, from what its stages kept") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip.avi", {160, 120}, 14, 9);
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"--bottom-up"}, {"--curve-events"}, {}}) {
    const auto run = (temp / "run").string();
    const auto analyze = [&](const char* graphs) {
      std::vector<std::string> words = {"analyze", clip, "-o", run, "-q", "--overwrite", graphs};
      words.insert(words.end(), how.begin(), how.end());
      return run_command(words).exit;
    };
    REQUIRE(analyze("--jsonl") == 0);
    const auto motion = bytes_of(temp / "run/motion.jsonl");
    REQUIRE(analyze("--no-jsonl") == 0);
    REQUIRE(
        run_command({"export", run, "--csv", "-q", "-o", (temp / "tables").string(), "--overwrite"}).exit ==
        0);
    CHECK(bytes_of(temp / "tables/strokes.csv") == bytes_of(temp / "run/strokes.csv"));
    CHECK(bytes_of(temp / "tables/trajectories.csv") == bytes_of(temp / "run/trajectories.csv"));
    REQUIRE(run_command({"export", run, "--jsonl", "-q"}).exit == 0);
    CHECK(bytes_of(temp / "run/motion.jsonl") == motion);
  }
  fs::remove(temp / "run/motion.jsonl");
  fs::remove_all(temp / "run/stages");
  check_one_line({"export", (temp / "run").string(), "--csv", "-q"}, 1, {"--jsonl"});
}
