// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/analyze_options.hpp"
#include "apps/runs/run_folder.hpp"
#include "core/io/files.hpp"
#include "core/text/format_number.hpp"
#include "graph/io/review_io.hpp"
#include "graph/io/units.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Analyze : AskedAnalysis {
  std::string output, review;
};

std::vector<std::string> inputs_of(const Analyze& asked) {
  return {asked.reading.clip, asked.reading.options.mask, asked.review};
}

Json read_summary(const std::string& folder) {
  auto in = io::open_file(std::filesystem::path(folder) / "summary.json");
  Json summary = Json::parse(in, nullptr, false);
  if (summary.is_discarded())
    throw core::IoError(folder + "/summary.json is damaged; remove it to analyze again");
  return summary;
}

void tell_done(const std::string& folder, bool before, const Json& summary, Session& session) {
  const auto report = (std::filesystem::path(folder) / "report.html").string();
  session.console.say(summary["events"]["total"].dump() + " events in " + summary["clip"]["frames"].dump() +
                      " frames; the report is " + report + (before ? ", as it was" : ""));
  if (session.common.json) session.print(json_text(summary));
}

/// Writes the events as soon as they are known, and removes results of an older run with other events.
void publish_events(const Analyze& asked, const pipeline::Analysis& found, const graph::Units& units,
                    const Session& session) {
  io::OutputFolder early(asked.output, session.common.existing());
  early.protect(inputs_of(asked));
  write_events(early, found, units);
  early.commit();
  note_events(asked.output);
  std::error_code ignored;
  for (const char* name : {"report.html", "summary.json"})
    std::filesystem::remove(std::filesystem::path(asked.output) / name, ignored);
}

/// Removes the graphs that an earlier run wrote as text: they may differ from this run's.
void remove_graphs(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : {"motion.jsonl", "sketch.jsonl"}) std::filesystem::remove(folder / name, ignored);
}

/// Computes the missing parts of a run. Without keys no intermediate results are stored.
Json make_run(const Analyze& asked, const AnalyzeOptions& options, const std::optional<RunKeys>& keys,
              Session& session) {
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect(inputs_of(asked));
  std::optional<pipeline::AnalysisStages> stages;
  if (keys) {
    note_begun(asked.output);
    stages.emplace(asked.output, keys->stages);
    stages->on_events = [&](const pipeline::Analysis& found, const core::ClipInfo& info) {
      publish_events(asked, found, graph::units_of(info), session);
    };
  }
  auto analysis =
      analyze_clip(asked.reading.clip, options, output, session, {}, {}, stages ? &*stages : nullptr);
  finish_analysis(analysis, output, session);
  output.commit();
  if (!options.jsonl) remove_graphs(asked.output);
  if (keys) note_done(asked.output, keys->run);
  return std::move(analysis.summary);
}

void run_analyze(const Analyze& asked, Session& session) {
  AnalyzeOptions options = check_analysis(asked, session);
  if (!asked.review.empty()) {
    auto in = io::open_file(asked.review);
    options.review = graph::read_review(in, asked.review);
  }
  require_apart(
      inputs_of(asked), asked.output,
      {"overlay.mp4",     "reconstruction.avi", "birth_map.png",    "death_map.png",   "matches",
       "model",           "events.json",        "events.csv",       "events_all.json", "motion.jsonl",
       "sketch.jsonl",    "trajectories.csv",   "strokes.csv",      "curves.csv",      "joints.csv",
       "network.csv",     "contacts.csv",       "named_events.csv", "lives.csv",       "drift.csv",
       "report.html",     "review.html",        "topology.csv",     "tips.csv",        "summary.json",
       "trajectories.png"},
      session.common);
  const auto keys = run_keys(asked.reading.clip, asked.review, options, session.common.seed);
  if (keys && is_done(asked.output, keys->run)) {
    tell_done(asked.output, true, read_summary(asked.output), session);
    return;
  }
  try {
    const auto summary = make_run(asked, options, keys, session);
    tell_done(asked.output, false, summary, session);
  } catch (const core::Cancelled&) {
    std::error_code error;
    if (!keys || !std::filesystem::exists(std::filesystem::path(asked.output) / "stages", error)) throw;
    throw core::Cancelled("what was done is kept in " + asked.output + ", the same command goes on");
  }
}

void apply_quality(const std::string& name, AnalyzeOptions& options) {
  const auto quality = pipeline::quality(name);
  if (!quality) throw Misuse("--quality is " + name + "; allowed is draft or normal");
  pipeline::set_quality(options, *quality);
}

}  // namespace

AnalyzeOptions check_analysis(const AskedAnalysis& asked, const Session& session) {
  AnalyzeOptions options = asked.options;
  apply_quality(asked.quality, options);
  options.read = check_reading(asked.reading, session);
  if (!(options.least_probability >= 0 && options.least_probability <= 1))
    throw Misuse("--least-probability is " + core::number_text(options.least_probability) +
                 "; allowed is 0 to 1");
  check_options(options.sketch, "sketch");
  check_options(options.match, "match");
  return options;
}

void add_analysis_options(CLI::App& command, AskedAnalysis& asked, CommandLine& line) {
  auto& options = asked.options;
  command
      .add_option("--quality", asked.quality,
                  "draft (events as matched) or normal (weighed by what the clip shows)")
      ->type_name("HOW")
      ->default_str(asked.quality);
  command.add_flag("--bottom-up", options.bottom_up,
                   "Take the match as it is: every event has probability 1");
  command.add_flag("--curve-events", options.curve_events,
                   "Events of curves, not of strokes: to touch and to cross is none");
  add_number(command, "--least-probability", options.least_probability, "P",
             "Report events of this probability or more; 0.5 if not given")
      ->default_str("");  // the column of names would be too wide
  const auto settings = add_settings(command, line);
  add_sketch_options(command, *settings, options.sketch);
  command.add_flag_callback(
      "--no-jsonl", [&options] { options.jsonl = false; },
      "Leave out the graphs as text, motion.jsonl and sketch.jsonl");
  command.add_flag_callback("--jsonl", [&options] { options.jsonl = true; })->group("");
  command.add_flag("--reconstruction", options.reconstruction,
                   "Write reconstruction.avi too, and measure the PSNR of every frame");
  settings->add("match", options.match);
}

void add_analyze(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "analyze",
                              "Follow the strokes of a clip, find their events and learn how they move", R"(
  emberfold analyze fire.mp4 -o out/fire
  emberfold analyze frames/ -o out/sea --range 0:100 --scale 0.5
  emberfold analyze builtin:cloth -o out/cloth --json | jq .events)");
  const auto asked = std::make_shared<Analyze>();
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  command
      ->add_option("--review", asked->review,
                   "Take this review.json's answers as facts (review.html makes it)")
      ->type_name("FILE");
  add_analysis_options(*command, *asked, line);
  finish_command(*command, line, asked, run_analyze);
}

}  // namespace emberfold::apps
