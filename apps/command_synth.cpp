// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/clip_writer.hpp"
#include "apps/command_line.hpp"
#include "apps/draw.hpp"
#include "apps/draw_model.hpp"
#include "apps/edit_options.hpp"
#include "apps/files.hpp"
#include "apps/interrupt.hpp"
#include "apps/model_folder.hpp"
#include "apps/overlay.hpp"
#include "apps/report_model.hpp"
#include "apps/summary.hpp"
#include "graph/motion_io.hpp"
#include "mcmc/synthesize.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Synth {
  std::string model, output, overlay, motion, fill_name = "diffusion";
  int frames = 300;
  sketch::FillOptions fill;
  EditOptions edit;
};

struct OpenedModel {
  mcmc::MotionModel motion;
  Ground ground;
};
OpenedModel open_model(const std::string& folder) {
  const auto archive = read_model(folder, kMotionFormat);
  try {
    OpenedModel opened{mcmc::motion_model(archive), {}};
    opened.ground = read_ground(archive, {opened.motion.width, opened.motion.height});
    return opened;
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
}

std::unique_ptr<ClipWriter> create_output(const std::string& path, cv::Size size, double fps, bool colour) {
  try {
    return create_clip(path, size, fps, colour);
  } catch (const core::InputError& error) {
    throw Misuse(error.what());
  }
}

void check(Synth& asked) {
  if (asked.frames < 1 || asked.frames > 1'000'000)
    throw Misuse("--frames is " + std::to_string(asked.frames) + ", must be in 1…1000000");
  check_options(asked.fill);
  check(asked.edit);
}

/// The graphs with their links, where somebody asks for them.
std::optional<graph::MotionGraph> make_motion(const Synth& asked, const mcmc::MotionModel& model,
                                              const Session& session) {
  if (asked.motion.empty() && asked.overlay.empty()) return std::nullopt;
  auto made = mcmc::synthesize(model, asked.frames, session.common.seed, session.context, asked.edit.start());
  if (made.status == core::Status::cancelled) throw Interrupted{};
  return std::move(made.motion);
}

/// Draws and writes all that was asked for; nothing takes its name before everything is whole.
SynthesisFigures write_clips(const Synth& asked, const mcmc::MotionModel& model, const FrameLook& look,
                             const Session& session) {
  const auto clip = create_output(asked.output, look.size, model.fps, look.channels == 3);
  std::optional<BesideFile> motion_file;
  if (!asked.motion.empty()) motion_file.emplace(asked.motion);
  const auto motion = make_motion(asked, model, session);
  std::vector<graph::Event> events;
  if (!asked.overlay.empty()) events = graph::stroke_events(*motion);
  if (motion_file) motion_file->write([&](std::ostream& out) { graph::write_motion(out, *motion); });
  std::unique_ptr<ClipWriter> overlay;
  auto info = core::ClipInfo{look.size.width, look.size.height, look.channels, CV_8U, model.fps, 255, {}};
  auto figures = draw_model(
      model, asked.frames, session.common.seed, look, session.context,
      [&](int t, const cv::Mat& frame) {
        clip->write(frame);
        if (asked.overlay.empty()) return;
        const cv::Mat shown = draw_overlay(to_colour_bytes(frame, info),
                                           motion->sketch.frames[static_cast<std::size_t>(t)], t, events);
        if (!overlay) overlay = create_output(asked.overlay, shown.size(), model.fps, true);
        overlay->write(shown);
      },
      asked.edit.start());
  session.check_stop();
  if (overlay) overlay->finish();
  if (motion_file) motion_file->finish();
  clip->finish();
  return figures;
}

Json summarise(const Synth& asked, const mcmc::MotionModel& model, const FrameLook& look,
               const SynthesisFigures& figures, const Session& session) {
  Json summary = begin_summary("synth", session);
  summary["model"] = {{"folder", asked.model}, {"learned_from_frames", model.frames}};
  summary["model"].update(motion_model_figures(model));
  const core::ClipInfo info{look.size.width, look.size.height, look.channels, CV_8U, model.fps, 255, {}};
  summary["clip"] = clip_json(asked.output, info, asked.frames);
  summary["options"] = {{"synth", {{"frames", asked.frames}, {"fill", asked.fill_name}}},
                        {"edit", edit_json(asked.edit)},
                        {"fill", options_json(asked.fill)}};
  summary["synthesis"] = figures.json();
  summary["files"] = {{asked.output, "the new clip"}};
  if (!asked.motion.empty()) summary["files"][asked.motion] = "its graphs and their links";
  if (!asked.overlay.empty()) summary["files"][asked.overlay] = "the clip under its graph, with its events";
  summary["warnings"] = session.warnings;
  return summary;
}

void run_synth(Synth asked, Session& session) {
  check(asked);
  Stages stages;
  stages.begin("read");
  auto [model, ground] = open_model(asked.model);
  stages.begin("edit");
  model = edited(std::move(model), asked.edit, session);
  stages.begin("synthesize");
  const auto look = model_look(model, std::move(ground), asked.fill);
  const auto figures = write_clips(asked, model, look, session);
  stages.end();
  session.console.say(std::to_string(asked.frames) + " frames drawn from " + asked.model + " into " +
                      asked.output);
  if (!session.common.json) return;
  Json summary = summarise(asked, model, look, figures, session);
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  session.print(json_text(summary));
}

}  // namespace

void add_synthesis(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("synth", "Draw a new clip from a motion model");
  command->footer(
      "  emberfold synth out/fire/model -o new_fire.mp4\n"
      "  emberfold synth out/fire/model -o frames --frames 1000 --seed 7 --motion new_fire.jsonl");
  const auto asked = std::make_shared<Synth>();
  command->add_option("MODEL", asked->model, "The model's folder, as analyze writes it (DIR/model)")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", asked->output,
                   "The new clip: .mp4 (H.264), .avi (lossless), or no extension (a folder of PNG)")
      ->type_name("OUT")
      ->required();
  add_number(*command, "--frames", asked->frames, "N", "How many frames");
  command->add_option("--fill", asked->fill_name, "How the ground between strokes is made")
      ->type_name("diffusion")
      ->check(CLI::IsMember({"diffusion"}).description(""))
      ->default_str(asked->fill_name);
  command->add_option("--motion", asked->motion, "Write the graphs and their links too (motion.jsonl)")
      ->type_name("FILE");
  command->add_option("--overlay", asked->overlay, "Write the clip under its graph too, with its events")
      ->type_name("OUT");
  add_fields(*command, asked->fill, "Filling");
  add_edit_options(*command, asked->edit);
  add_common(*command, chosen.common, "Print what was drawn as JSON");
  command->callback(
      [asked, &chosen] { chosen.run = [asked](Session& session) { run_synth(*asked, session); }; });
}

}  // namespace emberfold::apps
