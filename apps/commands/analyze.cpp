// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/analysis.hpp"

namespace emberfold::apps {

namespace {

struct Analyze {
  Reading reading;
  std::string output;
  AnalyzeOptions options;
};

void run_analyze(const Analyze& asked, Session& session) {
  AnalyzeOptions options = asked.options;
  options.read = check_reading(asked.reading, session);
  if (options.texture < 0 || options.texture > 500)
    throw Misuse("--texture is " + std::to_string(options.texture) + ", must be in 0…500");
  check_options(options.sketch);
  check_options(options.match);
  check_options(options.starts);
  check_options(options.infer);
  check_options(options.fill);
  check_options(options.calibrate);
  require_apart({asked.reading.clip}, asked.output,
                {"overlay.mp4", "reconstruction.avi", "birth_map.png", "death_map.png", "matches", "model"});
  io::OutputFolder output(asked.output);
  output.protect({asked.reading.clip});
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

void add_analyze(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("analyze", "Follow the strokes of a clip and find their events");
  command->footer(
      "  emberfold analyze fire.mp4 -o out/fire\n"
      "  emberfold analyze frames/ -o out/sea --range 0:100 --scale 0.5\n"
      "  emberfold analyze builtin:cloth -o out/cloth --json | jq .events");
  const auto asked = std::make_shared<Analyze>();
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  command->add_flag("--reconstruction", asked->options.reconstruction,
                    "Write reconstruction.avi too, and measure every frame's PSNR");
  add_number(
      *command, "--texture", asked->options.texture, "N",
      "Learn what lies between strokes too, a linear dynamic texture of so many components, for 'synth "
      "--fill dytex'; 0: none");
  add_fields(*command, asked->options.sketch, "Sketching");
  add_fields(*command, asked->options.match, "Matching");
  command->add_flag("--bottom-up", asked->options.bottom_up,
                    "No sampler: the match as it is, every event of probability 1");
  add_fields(*command, asked->options.starts, "Sampling");
  add_fields(*command, asked->options.infer, "Sampling");
  add_fields(*command, asked->options.calibrate, "The model");
  add_fields(*command, asked->options.fill, "Filling");
  add_common(*command, chosen.common, "Print the content of summary.json");
  command->callback(
      [asked, &chosen] { chosen.run = [asked](Session& session) { run_analyze(*asked, session); }; });
}

}  // namespace emberfold::apps
