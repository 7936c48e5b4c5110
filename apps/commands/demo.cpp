// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/builtin/builtin_clip.hpp"
#include "apps/builtin/open_clip.hpp"
#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/analysis.hpp"
#include "apps/commands/demo_story.hpp"
#include "core/io/clip_writer.hpp"
#include "core/text/format_number.hpp"
#include "graph/io/motion_io.hpp"

namespace emberfold::apps {

namespace {

struct Demo {
  std::string output = "out/demo", clip = "fire";
};

BuiltinClip make_clip(const Demo& asked, io::OutputFolder& output, const Session& session) {
  BuiltinOptions options;
  options.scene = builtin_scene(asked.clip);
  options.seed = session.common.seed;
  auto made = make_builtin(options, session.context);
  session.check_stop();
  const auto& info = made.clip.info;
  try {
    const auto writer =
        io::create_video(output.staged("clip.avi"), {info.width, info.height}, info.fps, info.channels == 3);
    for (const auto& frame : made.clip.frames) writer->write(frame);
    writer->finish();
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
  output.write("truth.json", [&](std::ostream& out) { out << made.truth_json; });
  return made;
}

std::string findings(const nlohmann::ordered_json& summary, const std::filesystem::path& folder) {
  std::ostringstream out;
  out << summary["clip"]["frames"] << " frames, " << summary["sketch"]["strokes_per_frame"]
      << " strokes a frame, " << summary["events"]["total"] << " events:";
  for (const auto& [name, count] : summary["events"]["classes"].items()) out << ' ' << name << ' ' << count;
  const auto& all = summary["score"]["four"]["all"];
  out << "\nagainst the truth: precision "
      << number_text(std::round(all["precision"].get<double>() * 1000) / 1000) << ", recall "
      << number_text(std::round(all["recall"].get<double>() * 1000) / 1000) << ", F1 "
      << number_text(std::round(all["f1"].get<double>() * 1000) / 1000)
      << "\nthe report: " << (folder / "report.html").string();
  return out.str();
}

void run_demo(const Demo& asked, Session& session) {
  io::OutputFolder output(asked.output, session.common.existing());
  const BuiltinClip made = make_clip(asked, output, session);
  std::istringstream truth_text(made.truth_json);
  const auto truth = graph::read_events(truth_text, "truth.json");
  AnalyzeOptions options;
  options.reconstruction = true;
  // Reads the file rather than the clip in memory, as the printed command does.
  auto analysis = analyze_clip(output.staged("clip.avi").string(), options, output, session, truth,
                               "builtin:" + asked.clip);
  const auto source = open_clip(output.staged("clip.avi").string(), {}, {});
  add_model_clips(*source, options, analysis, output, session);
  finish_analysis(analysis, output, session);
  const auto& summary = analysis.summary;
  output.write("score.json", [&](std::ostream& out) { out << json_text(summary["score"]); });
  output.commit();
  session.console.say(findings(summary, output.path()));
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_demo(CLI::App& app, CommandLine& line) {
  auto* command = add_command(
      app, "demo", "Make a built-in clip, analyze it, score its events, draw new clips from its models", R"(
  emberfold demo
  emberfold demo --clip cloth -o out/cloth --seed 7)");
  const auto asked = std::make_shared<Demo>();
  add_output(*command, asked->output);
  command->add_option("--clip", asked->clip, "Use this clip")
      ->type_name("fire|cloth|river")
      ->check(CLI::IsMember({"fire", "cloth", "river"}).description(""))
      ->default_str(asked->clip);
  finish_command(*command, line, asked, run_demo);
}

}  // namespace emberfold::apps
