// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/command_dytex.hpp"
#include "apps/interrupt.hpp"
#include "apps/summary.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Synth {
  std::string model, output, start = "stationary";
  int frames = 300;
  bool noise = false;
};

std::optional<int> start_frame(const Synth& asked, const dytex::LinearDynamicTexture& texture) {
  if (asked.start == "stationary") return std::nullopt;
  const auto last = texture.states.cols() - 1;
  const auto refuse = [&] {
    throw Misuse("--start is " + one_line(asked.start) +
                 "; allowed is stationary, or a frame of the clip that " + asked.model +
                 " was learned from, 0 to " + std::to_string(last));
  };
  int frame = 0;
  try {
    parse_number("--start", asked.start, frame);
  } catch (const CLI::ValidationError&) {
    refuse();
  }
  if (frame < 0 || frame > last) refuse();
  return frame;
}

void run_synth(const Synth& asked, Session& session) {
  constexpr int kMostFrames = 1'000'000;
  if (asked.frames < 1 || asked.frames > kMostFrames)
    throw Misuse("--frames is " + std::to_string(asked.frames) + "; allowed is 1 to " +
                 std::to_string(kMostFrames));
  Stages stages;
  stages.begin("read");
  const auto texture = read_texture(asked.model);
  dytex::SynthesisOptions options;
  options.seed = session.common.seed;
  options.first_frame = start_frame(asked, texture);
  options.pixel_noise = asked.noise;
  stages.begin("synthesize");
  const auto& info = texture.info;
  const auto writer = create_output(asked.output, info);
  dytex::Synthesis synthesis(texture, options);
  for (int t = 0; t < asked.frames; ++t) {
    session.context.report("synthesize", double(t) / asked.frames);
    writer->write(synthesis.next());
    session.check_stop();
  }
  writer->finish();
  stages.end();
  session.console.say(std::to_string(asked.frames) + " frames drawn into " + asked.output);
  if (!session.common.json) return;
  Json summary = begin_summary("dytex synth", session);
  summary["model"] = asked.model;
  summary["output"] = asked.output;
  summary["clip"] = clip_json(asked.output, info, asked.frames);
  summary["options"] = {{"start", asked.start}, {"noise", asked.noise}};
  summary["warnings"] = session.warnings;
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  session.print(json_text(summary));
}

}  // namespace

void add_dytex_synth(CLI::App& dytex, Chosen& chosen) {
  auto* command = dytex.add_subcommand("synth", "Draw a new clip from a linear dynamic texture");
  command->footer(
      "  emberfold dytex synth out/flag -o flag.mp4\n"
      "  emberfold dytex synth out/flag -o frames --frames 1000 --seed 7\n"
      "  emberfold dytex synth out/flag -o flag.avi --start 0 --noise");
  const auto asked = std::make_shared<Synth>();
  add_texture_model(*command, asked->model);
  command
      ->add_option("-o,--output", asked->output, "Clip to write: .mp4, .avi (lossless), or a folder of PNG")
      ->type_name("OUT")
      ->required();
  const char* group = "Synthesis";
  add_number(*command, "--frames", asked->frames, "N", "How many frames")->group(group);
  command->add_option("--start", asked->start, "The first state: drawn by chance, or that of a learned frame")
      ->type_name("stationary|N")
      ->default_str(asked->start)
      ->group(group);
  command->add_flag("--noise", asked->noise, "Add the noise of what the components leave out")->group(group);
  add_common(*command, chosen.common, "Print figures as JSON");
  command->callback(
      [asked, &chosen] { chosen.run = [asked](Session& session) { run_synth(*asked, session); }; });
}

}  // namespace emberfold::apps
