// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/analysis.hpp"
#include "core/io/files.hpp"
#include "graph/io/review_io.hpp"

namespace emberfold::apps {

namespace {

struct Analyze {
  Reading reading;
  std::string output, review;
  AnalyzeOptions options;
};

void run_analyze(const Analyze& asked, Session& session) {
  AnalyzeOptions options = asked.options;
  options.read = check_reading(asked.reading, session);
  if (options.texture < 0 || options.texture > 500)
    throw Misuse("--texture is " + std::to_string(options.texture) + "; allowed is 0 to 500");
  check_options(options.sketch, "sketch");
  check_options(options.match, "match");
  check_options(options.starts, "starts");
  check_options(options.infer, "infer");
  check_options(options.fill, "fill");
  check_options(options.calibrate, "calibrate");
  if (!asked.review.empty()) {
    auto in = io::open_file(asked.review);
    options.review = graph::read_review(in, asked.review);
  }
  const std::vector<std::string> inputs{asked.reading.clip, asked.reading.options.mask, asked.review};
  require_apart(inputs, asked.output,
                {"overlay.mp4",  "reconstruction.avi", "birth_map.png",    "death_map.png",   "matches",
                 "model",        "events.json",        "events.csv",       "events_all.json", "motion.jsonl",
                 "sketch.jsonl", "trajectories.csv",   "strokes.csv",      "curves.csv",      "joints.csv",
                 "network.csv",  "contacts.csv",       "named_events.csv", "lives.csv",       "drift.csv",
                 "report.html",  "review.html",        "topology.csv",     "tips.csv",        "summary.json"},
                session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect(inputs);
  auto analysis = analyze_clip(asked.reading.clip, options, output, session);
  finish_analysis(analysis, output, session);
  output.commit();
  const auto& summary = analysis.summary;
  const auto report = (output.path() / "report.html").string();
  session.console.say(summary["events"]["total"].dump() + " events in " + summary["clip"]["frames"].dump() +
                      " frames; the report is " + report);
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_analyze(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "analyze",
                              "Follow the strokes of a clip, find their events and learn how they move", R"(
  emberfold analyze fire.mp4 -o out/fire
  emberfold analyze frames/ -o out/sea --range 0:100 --scale 0.5
  emberfold analyze builtin:cloth -o out/cloth --json | jq .events)");
  const auto asked = std::make_shared<Analyze>();
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  auto& options = asked->options;
  auto* bottom_up = command->add_flag("--bottom-up", options.bottom_up,
                                      "Take the match as it is: every event has probability 1");
  auto* curve_events = command->add_flag("--curve-events", options.curve_events,
                                         "Events of curves, not of strokes: to touch and to cross is none");
  command
      ->add_flag("--sample", options.sample,
                 "Sample graphs and links by MCMC (slow; see docs/method/sampler.md)")
      ->excludes(bottom_up)
      ->excludes(curve_events);
  command
      ->add_option("--review", asked->review,
                   "Take this review.json's answers as facts (review.html makes it)")
      ->type_name("FILE");
  add_sketch_options(*command, options.sketch);
  command->add_flag("--reconstruction", options.reconstruction,
                    "Write reconstruction.avi too, and measure the PSNR of every frame");
  add_number(*command, "--texture", options.texture, "N",
             "Learn N components of what lies between strokes (synth --fill dytex)");
  const auto settings = add_settings(*command, line);
  settings->add("sketch", options.sketch);
  settings->add("match", options.match);
  settings->add("starts", options.starts);
  settings->add("infer", options.infer);
  settings->add("calibrate", options.calibrate);
  settings->add("fill", options.fill);
  finish_command(*command, line, asked, run_analyze);
}

}  // namespace emberfold::apps
