// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/edit_options.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/report/report_model.hpp"
#include "apps/synthesis/outputs.hpp"
#include "apps/synthesis/request.hpp"
#include "core/io/require_apart.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/footage/footage_synthesis.hpp"

namespace emberfold::apps {

namespace {

pipeline::SynthesisMethod parse_method(const std::string& text) {
  if (const auto method = pipeline::synthesis_method(text)) return *method;
  throw Misuse("--method is " + text + "; allowed is one of footage, edit, strokes, diffusion, texture");
}

using Json = nlohmann::ordered_json;

/// Draws and writes all requested files. An interrupted run keeps the frames so far.
void write_clips(const SynthRequest& asked, SynthOutputs& outputs, pipeline::ClipSynthesis& frames,
                 const Session& session) {
  try {
    session.context.report("synthesize", 0);
    const auto write = [&](const cv::Mat& frame) {
      outputs.write(frame);
      session.context.report("synthesize", double(outputs.frames()) / asked.frames);
    };
    frames.each(asked.frames, write);
    session.check_stop();
  } catch (const core::Cancelled&) {
    if (outputs.frames() == 0) throw;
    outputs.finish();
    throw core::Cancelled{asked.output + " holds the " + std::to_string(outputs.frames()) + " of " +
                          std::to_string(asked.frames) + " frames that were drawn"};
  }
  outputs.finish();
}

double mean(const std::vector<std::size_t>& values) {
  const double sum = static_cast<double>(std::accumulate(values.begin(), values.end(), std::size_t{0}));
  return std::round(100 * sum / static_cast<double>(std::max<std::size_t>(1, values.size()))) / 100;
}

Json statistics_json(const pipeline::SynthesisStatistics& drawn) {
  Json counts = Json::object();
  for (std::size_t i = 0; i < drawn.operators.size(); ++i)
    counts[std::string(graph::name(graph::all_event_types()[i]))] = drawn.operators[i];
  Json figures = {{"patches_per_frame", mean(drawn.patches)},
                  {"strokes_per_frame", mean(drawn.strokes)},
                  {"operators", counts}};
  if (drawn.edited) figures["edited_moments"] = *drawn.edited;
  if (drawn.copied_share) figures["copied_share"] = std::round(100 * *drawn.copied_share) / 100;
  return figures;
}

/// Lists figures of a clip made of footage; at a jump_cost of 1, jumps change as much as any frame does.
Json footage_json(const pipeline::FootageSynthesis& drawn) {
  const auto rounded = [](double value) { return std::round(100 * value) / 100; };
  return {{"jump_cost", rounded(drawn.jump_cost())},
          {"plays", drawn.plays()},
          {"plays_back", drawn.plays_back()},
          {"time_spread_frames", rounded(drawn.amplitude())},
          {"copied_share", rounded(drawn.copied_share())}};
}

/// Warns where an edit of the clip's own strokes shows in no frame.
void warn_of_no_effect(const mcmc::MotionEdit& edit, int count, const pipeline::ClipSynthesis& frames,
                       const Session& session) {
  mcmc::MotionEdit only_played;
  only_played.speed = edit.speed, only_played.reverse = edit.reverse;
  const auto* const strokes = frames.statistics();
  if (edit == only_played || strokes == nullptr || strokes->edited != std::size_t{0}) return;
  session.context.warn("the edit shows in none of the " + std::to_string(count) +
                       " frames: what it multiplies or hides is rare in this clip, or cannot be hidden; "
                       "--method diffusion draws strokes instead");
}

/// Says how much of the clip is copied, or why strokes are drawn.
std::string how_drawn(const SynthRequest& asked, const pipeline::ClipSynthesis& frames) {
  const auto* const footage = frames.footage();
  const auto* const strokes = frames.statistics();
  const auto copied = footage != nullptr   ? std::optional(footage->copied_share())
                      : strokes != nullptr ? strokes->copied_share
                                           : std::nullopt;
  std::string text;
  if (copied)
    text =
        "; " + std::to_string(std::lround(100 * *copied)) + " % of what moves is as in one frame of the clip";
  if (footage != nullptr && footage->plays_back()) text += "; it has no like moments and is played back, too";
  return asked.drawn_since.empty() ? text : text + "; " + asked.drawn_since;
}

Json summarise(const SynthRequest& asked, const mcmc::MotionModel& model,
               const pipeline::ClipSynthesis& frames, const SynthOutputs& outputs, const Session& session) {
  Json summary = begin_summary("synth", session);
  summary["model"] = {{"folder", asked.model}, {"learned_from_frames", model.frames}};
  summary["model"].update(motion_model_figures(model));
  summary["clip"] = clip_json(asked.output, outputs.info(), asked.frames);
  Json edits = edit_json(asked.edit);
  edits["start"] = asked.start;
  summary["options"] = {{"synth",
                         {{"frames", asked.frames},
                          {"method", pipeline::name(frames.method())},
                          {"loop", asked.loop ? Json(*asked.loop) : Json(nullptr)},
                          {"alpha", asked.alpha.empty() ? Json(nullptr) : Json(asked.alpha)}}},
                        {"edit", edits}};
  const auto* const strokes = frames.statistics();
  summary["synthesis"] = frames.footage()     ? footage_json(*frames.footage())
                         : strokes != nullptr ? statistics_json(*strokes)
                                              : Json::object();
  summary["files"] = {{asked.output, "the new clip"}};
  if (!asked.motion.empty()) summary["files"][asked.motion] = "its graphs and their links";
  if (!asked.film.empty()) summary["files"][asked.film] = "the clip, the drawn sketch and the drawn frame";
  if (!asked.overlay.empty()) summary["files"][asked.overlay] = "the clip under its graph, with its events";
  return summary;
}

void run_synth(SynthRequest asked, Session& session) {
  check(asked);
  io::require_apart({asked.model, asked.edit.birth_map, asked.alpha},
                    {{asked.output}, {asked.overlay}, {asked.motion}, {asked.film}});
  require_new({asked.output, asked.overlay, asked.motion, asked.film}, session.common);
  Stages stages;
  stages.begin("read");
  auto opened = pipeline::read_clip_model(asked.model, asked.method);
  stages.begin("edit");
  const auto& edit = asked.edit.edit;
  const bool carries =
      asked.method == pipeline::SynthesisMethod::edit || asked.method == pipeline::SynthesisMethod::strokes;
  const bool plays = opened.footage && !carries;  // another speed is a matter of playing, not an edit
  if (!plays && !carries) opened = apply_edits(std::move(opened), asked.edit, session);
  stages.begin("synthesize");
  const pipeline::ClipSynthesisOptions options{
      .seed = session.common.seed,
      .method = asked.method,
      .start = asked.first(),
      .speed = !plays         ? 1
               : edit.reverse ? -edit.speed
                              : edit.speed,
      .edit = carries ? read_edit(asked.edit, opened.motion) : mcmc::MotionEdit{},
      .loop = asked.loop};
  pipeline::ClipSynthesis frames(opened, options, session.context);
  SynthOutputs outputs(asked, frames);
  write_clips(asked, outputs, frames, session);
  stages.end();
  warn_of_no_effect(options.edit, asked.frames, frames, session);
  session.console.say(std::to_string(asked.frames) + " frames drawn from " + asked.model + " into " +
                      asked.output + how_drawn(asked, frames));
  if (!session.common.json) return;
  Json summary = summarise(asked, opened.motion, frames, outputs, session);
  end_summary(summary, session, stages);
  session.print(json_text(summary));
}

}  // namespace

void add_synthesis(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "synth", "Draw a new clip from a motion model", R"(
  emberfold synth out/fire/model -o endless.mp4 --loop 120
  emberfold synth out/fire/model -o frames --frames 1000 --method diffusion --motion new_fire.jsonl)");
  const auto asked = std::make_shared<SynthRequest>();
  command->add_option("MODEL", asked->model, "Read the model from this folder, DIR/model of analyze")
      ->required()
      ->type_name("");
  add_clip_output(*command, asked->output);
  auto* frames = add_number(*command, "--frames", asked->frames, "N", "Draw this many frames");
  command
      ->add_option_function<std::string>(
          "--method", [asked](const std::string& text) { asked->method = parse_method(text); },
          "Use footage, edit, strokes (at new times), diffusion or texture")
      ->type_name("KIND")
      ->default_str("footage");
  command->add_option("--loop", asked->loop, "Draw N frames that repeat without a seam")->type_name("N");
  command
      ->add_option("--motion", asked->motion,
                   "Write graphs and links, as motion.jsonl; --overlay OUT draws them")
      ->type_name("FILE");
  // Described with --motion, so that the help fits on one screen; likewise others below.
  command->add_option("--overlay", asked->overlay, "Write the clip with its graph and events too")
      ->type_name("OUT")
      ->group("");
  command->add_option("--film", asked->film, "Write clip, sketch and frame in a row")->type_name("OUT");
  command
      ->add_option("--width", asked->width, "Scale frames to this width, px, or to --height N; larger, too")
      ->type_name("N");
  command->add_option("--height", asked->height, "Scale frames to this height, px")
      ->type_name("N")
      ->group("");
  command
      ->add_option("--alpha", asked->alpha,
                   "Write opacity over black, white, the clip's ground (ground) or a picture")
      ->type_name("GROUND");
  const auto settings = add_settings(*command, line);
  command
      ->add_option("--start", asked->start,
                   "Begin as in the clip (data) or as the model usually is (stationary)")
      ->type_name("KIND")
      ->check(CLI::IsMember({"data", "stationary"}).description(""))
      ->default_str(asked->start);
  add_edit_options(*command, asked->edit, *settings);
  finish_command(*command, line, asked, run_synth,
                 [asked, frames] { asked->asked_frames = frames->count() > 0; });
}

}  // namespace emberfold::apps
