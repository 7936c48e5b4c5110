// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "core/io/files.hpp"
#include "graph/exporting/stroke_tree.hpp"
#include "graph/exporting/tracking_files.hpp"
#include "graph/io/curve_tables.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/network_table.hpp"
#include "graph/io/units_json.hpp"
#include "pipeline/stages/kept_motion.hpp"

namespace emberfold::apps {

namespace {

namespace fs = std::filesystem;

struct Export {
  std::string run, output;
  bool jsonl = false, csv = false, geff = false, trackmate = false, graphml = false;
};

/// A run, read from its files.
struct FinishedRun {
  graph::MotionGraph motion;
  std::vector<graph::Event> events;
  graph::TrackedClip clip;
};

std::ifstream open_of_run(const fs::path& folder, const char* name) {
  std::error_code error;
  if (!fs::exists(folder / name, error))
    throw core::IoError(folder.string() + " is no finished run with graphs: it has no " + name +
                        "; 'emberfold analyze' makes one (with --jsonl where it was left out)");
  return io::open_file(folder / name);
}

/// Reads the graphs of a run: from motion.jsonl, or if that was not written from its stored stages.
graph::MotionGraph read_motion_of_run(const fs::path& folder, const nlohmann::json& summary) {
  std::error_code error;
  if (!fs::exists(folder / "motion.jsonl", error) && !summary.contains("review")) {
    const auto& options = summary.at("options");
    std::optional<double> least_probability;
    if (!options.at("bottom_up").get<bool>() && !options.at("curve_events").get<bool>())
      least_probability = options.at("least_probability").get<double>();
    if (auto motion = pipeline::read_kept_motion(folder, least_probability)) return *std::move(motion);
  }
  auto file = open_of_run(folder, "motion.jsonl");
  return graph::read_motion(file, (folder / "motion.jsonl").string());
}

FinishedRun read_finished_run(const fs::path& folder) {
  FinishedRun run;
  auto summary_file = open_of_run(folder, "summary.json"), events_file = open_of_run(folder, "events.json");
  run.events = graph::read_events(events_file, (folder / "events.json").string());
  try {
    const auto summary = nlohmann::json::parse(summary_file);
    run.motion = read_motion_of_run(folder, summary);
    const auto& clip = summary.at("clip");
    run.clip.name = clip.at("name").get<std::string>();
    run.clip.width = clip.at("width"), run.clip.height = clip.at("height"),
    run.clip.frames = clip.at("frames");
    run.clip.fps = clip.at("fps");
    run.clip.units = graph::read_units(clip);
    const auto& origin = run.clip.units.origin;
    run.events = graph::moved(std::move(run.events), {-origin.x, -origin.y});
  } catch (const nlohmann::json::exception&) {
    throw core::IoError((folder / "summary.json").string() + " is no summary of analyze");
  }
  return run;
}

std::vector<std::string> names_to_write(const Export& asked) {
  std::vector<std::string> names;
  if (asked.jsonl) names.insert(names.end(), {"motion.jsonl"});
  if (asked.csv)
    names.insert(names.end(),
                 {"events.csv", "strokes.csv", "trajectories.csv", "curves.csv", "lives.csv", "network.csv"});
  if (asked.geff) names.emplace_back("run.geff");
  if (asked.trackmate) names.emplace_back("trackmate.xml");
  if (asked.graphml) names.emplace_back("genealogy.graphml");
  return names;
}

void write_tables(const FinishedRun& run, io::OutputFolder& output) {
  const auto& units = run.clip.units;
  output.write("events.csv", [&](std::ostream& out) { graph::write_events_csv(out, run.events, units); });
  output.write("strokes.csv", [&](std::ostream& out) { graph::write_strokes(out, run.motion, units); });
  output.write("trajectories.csv",
               [&](std::ostream& out) { graph::write_trajectories(out, run.motion, units); });
  output.write("curves.csv", [&](std::ostream& out) { graph::write_curves(out, run.motion, units); });
  output.write("lives.csv",
               [&](std::ostream& out) { graph::write_lives(out, graph::stroke_lives(run.motion), units); });
  output.write("network.csv", [&](std::ostream& out) { graph::write_network(out, run.motion, units); });
}

void write_for_others(const Export& asked, const FinishedRun& run, io::OutputFolder& output) {
  if (!asked.geff && !asked.trackmate && !asked.graphml) return;
  const auto tree = graph::make_stroke_tree(run.motion, run.events);
  if (asked.geff)
    graph::write_geff(tree, run.clip, "run.geff",
                      [&](const std::string& path, const std::function<void(std::ostream&)>& body) {
                        output.make_subfolder(fs::path(path).parent_path().string());
                        output.write(path, body);
                      });
  if (asked.trackmate)
    output.write("trackmate.xml", [&](std::ostream& out) { graph::write_trackmate(out, tree, run.clip); });
  if (asked.graphml)
    output.write("genealogy.graphml", [&](std::ostream& out) { graph::write_graphml(out, tree, run.clip); });
}

void run_export(const Export& asked, Session& session) {
  const auto names = names_to_write(asked);
  if (names.empty())
    throw Misuse("nothing to export: give --jsonl, --csv, --geff, --trackmate or --graphml, or several");
  const std::string folder = asked.output.empty() ? asked.run : asked.output;
  if (folder != asked.run && !session.common.overwrite) io::require_own(folder, names);
  const auto run = read_finished_run(asked.run);
  io::OutputFolder output(folder, session.common.existing());
  if (asked.jsonl)
    output.write("motion.jsonl", [&](std::ostream& out) { graph::write_motion(out, run.motion); });
  if (asked.csv) write_tables(run, output);
  write_for_others(asked, run, output);
  session.check_stop();
  output.commit();
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const auto& name : names) files.push_back((fs::path(folder) / name).string());
  for (const auto& file : files) session.console.say(file.get<std::string>());
  if (session.common.json) session.print(json_text({{"files", files}}));
}

}  // namespace

void add_export(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "export", "Write a run's strokes and events for other programs", R"(
  emberfold export out/fire --geff --trackmate
  emberfold export out/fire --csv -o tables)");
  const auto asked = std::make_shared<Export>();
  command->add_option("RUN", asked->run, "Folder of analyze")->required()->type_name("");
  command->add_option("-o,--output", asked->output, "Write into this folder [RUN]")->type_name("DIR");
  command->add_flag("--jsonl", asked->jsonl, "Graphs and links: motion.jsonl");
  command->add_flag("--csv", asked->csv, "Tables of events, strokes, curves, lives, trajectories, network");
  command->add_flag("--geff", asked->geff, "Graph exchange file format (zarr): run.geff");
  command->add_flag("--trackmate", asked->trackmate, "TrackMate of Fiji: trackmate.xml");
  command->add_flag("--graphml", asked->graphml, "Genealogy of the strokes: genealogy.graphml");
  finish_command(*command, line, asked, run_export);
}

}  // namespace emberfold::apps
