// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/comparison/comparison.hpp"
#include "apps/comparison/comparison_table.hpp"
#include "apps/report/comparison_report.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Compare {
  Reading reading;
  std::string other, output;
  pipeline::CompareOptions options;
};

Json options_of(const Compare& asked, const io::ReadOptions& read) {
  Json options = {{"reading", reading_json(read)},
                  {"sketch", options_json(asked.options.sketch)},
                  {"match", options_json(asked.options.match)}};
  if (!asked.other.empty()) return options;
  options["comparison"] = options_json(asked.options);
  options["learn"] = options_json(asked.options.learn);
  return options;
}

void run_compare(const Compare& asked, Session& session) {
  const io::ReadOptions read = check_reading(asked.reading, session);
  check_options(asked.options, "compare");
  check_options(asked.options.sketch, "sketch");
  check_options(asked.options.match, "match");
  check_options(asked.options.learn, "learn");
  require_apart(
      {asked.reading.clip, asked.other, asked.reading.options.mask}, asked.output,
      {"side_by_side.mp4", "synthesized_motion.avi", "synthesized_dytex.avi", "synthesized_footage.avi",
       "synthesized_strokes.avi", "synthesized_star.avi", "video_loop.avi", "contact_sheet.png",
       "measures.json", "drift.csv", "report.html", "summary.json"},
      session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect({asked.reading.clip, asked.other, asked.reading.options.mask});

  Stages stages;
  stages.begin("compare");
  const auto open = [&](const std::string& name) { return open_held_clip(name, read, session); };
  const auto source = open(asked.reading.clip);
  Comparison comparison;
  if (asked.other.empty()) {
    comparison = compare_clip(*source, asked.reading.clip, asked.options, {}, output, session);
  } else {
    const auto other = open(asked.other);
    comparison =
        compare_clips(*source, asked.reading.clip, *other, asked.other, asked.options, output, session);
  }
  write_drift(output, *source);
  stages.end();
  Json summary = begin_summary("compare", session);
  summary["options"] = options_of(asked, read);
  summary["measures"] = comparison.measures;
  comparison.files.emplace_back("report.html");
  summary["files"] = comparison.files;
  end_summary(summary, session, stages);
  write_summary(output, summary);
  output.write("report.html", [&](std::ostream& out) { out << make_comparison_report(comparison, summary); });
  session.check_stop();
  output.commit();
  session.print(session.common.json ? json_text(summary) : comparison_table(comparison.measures));
  for (const auto& sentence : comparison.measures["words"]) session.console.say(sentence.get<std::string>());
  session.console.say("the report is " + (output.path() / "report.html").string());
}

}  // namespace

void add_compare(CLI::App& app, CommandLine& line) {
  auto* command =
      add_command(app, "compare", "Compare a clip with models learned from it, or with another clip", R"(
  emberfold compare flag.avi -o out/compare
  emberfold compare flame.mp4 -o out/compare --range 0:60 --scale 0.5
  emberfold compare flag.avi flag_synthesized.avi -o out/compare --json)");
  const auto asked = std::make_shared<Compare>();
  add_reading(*command, asked->reading);
  command->add_option("OTHER", asked->other, "Another clip to compare with; without it models are learned")
      ->type_name("");
  add_output(*command, asked->output);
  auto& options = asked->options;
  add_number(*command, "--frames", options.frames, "N",
             "Draw this many frames from each model; 0: as many as the clip has");
  const auto settings = add_settings(*command, line);
  settings->add("compare", options, {"frames"});
  add_sketch_options(*command, *settings, options.sketch);
  settings->add("match", options.match);
  settings->add("learn", options.learn);
  finish_command(*command, line, asked, run_compare);
}

}  // namespace emberfold::apps
