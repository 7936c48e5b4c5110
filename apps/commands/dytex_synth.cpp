// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "core/io/require_apart.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct TextureSynth {
  std::string model, output, start = "stationary";
  int frames = 300, loop = 0;
  bool noise = false, asked_frames = false, asked_loop = false, asked_start = false;
};

void check_lengths(TextureSynth& asked) {
  constexpr int kMostFrames = 1'000'000;
  const auto check = [](const char* name, int value) {
    if (value < 1 || value > kMostFrames)
      throw Misuse(std::string(name) + " is " + std::to_string(value) + "; allowed is 1 to " +
                   std::to_string(kMostFrames));
  };
  if (asked.asked_loop) check("--loop", asked.loop);
  if (asked.asked_loop && asked.asked_start)
    throw Misuse("--start is given beside --loop; a loop has no first state, so allowed is one of them");
  if (asked.asked_loop && !asked.asked_frames) asked.frames = asked.loop;
  check("--frames", asked.frames);
}

void run_texture_synth(TextureSynth asked, Session& session) {
  check_lengths(asked);
  io::require_apart({asked.model}, {{asked.output}});
  require_new({asked.output}, session.common);
  Stages stages;
  stages.begin("read");
  const auto texture = read_texture(asked.model);
  dytex::SynthesisOptions options;
  options.seed = session.common.seed;
  options.pixel_noise = asked.noise;
  options.loop = asked.loop;
  set_start(options, asked.start, texture, asked.model);
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
  session.console.say(std::to_string(asked.frames) + " frames drawn into " + asked.output +
                      (asked.loop > 0 ? "; they begin again after " + std::to_string(asked.loop) : ""));
  if (!session.common.json) return;
  Json summary = begin_summary("dytex synth", session);
  summary["model"] = asked.model;
  summary["output"] = asked.output;
  summary["clip"] = clip_json(asked.output, info, asked.frames);
  summary["options"] = {{"start", asked.start}, {"loop", asked.loop}, {"noise", asked.noise}};
  end_summary(summary, session, stages);
  session.print(json_text(summary));
}

}  // namespace

void add_dytex_synth(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(dytex, "synth", "Draw a new clip from a linear dynamic texture", R"(
  emberfold dytex synth out/flag -o flag.mp4
  emberfold dytex synth out/flag -o frames --frames 1000 --seed 7
  emberfold dytex synth out/flag -o flag.avi --start 0 --noise
  emberfold dytex synth out/flag -o endless.mp4 --loop 100)");
  const auto asked = std::make_shared<TextureSynth>();
  add_texture_model(*command, asked->model);
  add_clip_output(*command, asked->output);
  auto* frames = add_number(*command, "--frames", asked->frames, "N", "Draw this many frames");
  auto* start = add_start(*command, asked->start);
  auto* loop = add_number(*command, "--loop", asked->loop, "N", "Draw N frames that repeat without a seam");
  loop->default_str("");
  command->add_flag("--noise", asked->noise, "Add the noise of what the components leave out");
  finish_command(*command, line, asked, run_texture_synth, [asked, frames, start, loop] {
    asked->asked_frames = frames->count() > 0;
    asked->asked_start = start->count() > 0;
    asked->asked_loop = loop->count() > 0;
  });
}

}  // namespace emberfold::apps
