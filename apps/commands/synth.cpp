// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/edit_options.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/pictures/synthesis_film.hpp"
#include "apps/report/report_model.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/files.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/require_apart.hpp"
#include "graph/io/motion_io.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/clip_synthesis.hpp"

namespace emberfold::apps {

namespace {

pipeline::ModelFill parse_fill(const std::string& text) {
  if (const auto fill = pipeline::model_fill(text)) return *fill;
  throw Misuse("--fill is " + text + "; allowed is one of footage, carried, diffusion, texture, dytex");
}

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Synth {
  std::string model, output, overlay, motion, film;
  std::optional<pipeline::ModelFill> fill_kind;
  int frames = 300;
  std::optional<int> loop;
  bool asked_frames = false;
  std::string drawn_since;  ///< why strokes are drawn that were to be carried
  sketch::FillOptions fill;
  std::string start = "data";
  EditOptions edit;

  [[nodiscard]] mcmc::Start first() const {
    return start == "stationary" ? mcmc::Start::stationary : mcmc::Start::data;
  }
};

std::unique_ptr<io::VideoWriter> create_output(const std::string& path, cv::Size size, double fps,
                                               bool colour) {
  try {
    return io::create_video(path, size, fps, colour);
  } catch (const core::InputError& error) {
    throw Misuse(error.what());
  }
}

/// Returns the option that only drawn strokes can fulfil; empty where none was given.
std::string stroke_option(const Synth& asked) {
  if (!asked.motion.empty()) return "--motion";
  if (!asked.overlay.empty()) return "--overlay";
  if (!asked.film.empty()) return "--film";
  if (asked.start != "data") return "--start";
  return stroke_option(asked.edit);
}

/// Returns what cannot be shown with the clip's own strokes; empty where nothing was asked that cannot.
std::string not_carried(const Synth& asked) {
  return asked.start != "data" ? "--start" : pipeline::edit_not_carried(asked.edit.edit);
}

/// Chooses carried strokes where an option needs strokes, drawn ones where it needs these, and refuses
/// options that exclude each other.
void choose_fill(Synth& asked) {
  using pipeline::ModelFill;
  const auto option = stroke_option(asked);
  if (!option.empty() && asked.fill_kind == ModelFill::footage)
    throw Misuse(option +
                 " is for clips with strokes (--fill carried, diffusion, texture or dytex), not footage");
  const auto why = not_carried(asked);
  if (asked.fill_kind == ModelFill::carried && !why.empty())
    throw Misuse("--fill carried keeps the clip's own strokes; " + why + " needs drawn ones");
  if (!option.empty() && !asked.fill_kind) {
    if (!why.empty())
      asked.drawn_since = why + " needs drawn strokes";
    else if (!pipeline::holds_footage_strokes(asked.model))
      asked.drawn_since = "strokes are drawn, since the model holds none of its clip's frames";
    asked.fill_kind = asked.drawn_since.empty() ? ModelFill::carried : ModelFill::diffusion;
  }
  if (asked.loop && asked.fill_kind && asked.fill_kind != ModelFill::footage)
    throw Misuse("--loop is for clips made of footage; " + (option.empty() ? "--fill" : option) +
                 " draws strokes");
  if (asked.loop && *asked.loop < 2)
    throw Misuse("--loop is " + std::to_string(*asked.loop) + "; allowed is 2 or more");
  if (asked.loop && !asked.asked_frames) asked.frames = *asked.loop;
}

void check(Synth& asked) {
  if (asked.frames < 1 || asked.frames > 1'000'000)
    throw Misuse("--frames is " + std::to_string(asked.frames) + "; allowed is 1 to 1000000");
  check_options(asked.fill, "fill");
  check(asked.edit);
  choose_fill(asked);
}

/// The graphs with their links, where somebody asks for them: all are held.
std::optional<graph::MotionGraph> make_motion(const Synth& asked, const pipeline::ClipSynthesis& frames) {
  if (asked.motion.empty() && asked.overlay.empty() && asked.film.empty()) return std::nullopt;
  return frames.motion(asked.frames);
}

/// The frames of the clip that the model was learned from; none where it holds none.
pipeline::Footage clip_of(const std::string& folder, const core::ClipInfo& info) {
  io::ModelLimits limits;
  limits.parts = false;
  auto clip =
      pipeline::read_footage(io::read_model(folder, io::kMotionFormat, limits), {info.width, info.height});
  return clip.channels == info.channels ? clip : pipeline::Footage{};
}

/// Output files; none gets its name before finish().
class Outputs {
 public:
  Outputs(const Synth& asked, const pipeline::ClipSynthesis& frames)
      : asked_(asked),
        info_(frames.info()),
        clip_(create_output(asked.output, {info_.width, info_.height}, info_.fps, info_.channels == 3)) {
    if (!asked.motion.empty()) motion_file_.emplace(asked.motion);
    motion_ = make_motion(asked, frames);
    if (!asked.overlay.empty()) events_ = graph::stroke_events(*motion_);
    if (!asked.film.empty()) film_ = create_film(asked, info_);
  }

  void write(const cv::Mat& frame) {
    clip_->write(frame);
    const int t = frames_++;
    if (film_) film_->add(frame, motion_->sketch.frames[static_cast<std::size_t>(t)]);
    if (asked_.overlay.empty()) return;
    const cv::Mat shown = draw_overlay(to_colour_bytes(frame, info_),
                                       motion_->sketch.frames[static_cast<std::size_t>(t)], t, events_);
    if (!overlay_) overlay_ = create_output(asked_.overlay, shown.size(), info_.fps, true);
    overlay_->write(shown);
  }

  /// All of one length, that of the frames written.
  void finish() {
    if (motion_file_) {
      motion_->sketch.frames.resize(static_cast<std::size_t>(frames_));
      motion_->links.resize(static_cast<std::size_t>(frames_));
      motion_file_->write([&](std::ostream& out) { graph::write_motion(out, *motion_); });
    }
    if (overlay_) overlay_->finish();
    if (film_) film_->finish();
    if (motion_file_) motion_file_->finish();
    clip_->finish();
  }
  [[nodiscard]] int frames() const { return frames_; }

 private:
  static std::unique_ptr<SynthesisFilm> create_film(const Synth& asked, const core::ClipInfo& info) {
    try {
      return std::make_unique<SynthesisFilm>(asked.film, clip_of(asked.model, info), info, asked.frames);
    } catch (const core::InputError& error) {
      throw Misuse(error.what());
    }
  }

  const Synth& asked_;
  core::ClipInfo info_;
  std::unique_ptr<io::VideoWriter> clip_, overlay_;
  std::unique_ptr<SynthesisFilm> film_;
  std::optional<io::StagedFile> motion_file_;
  std::optional<graph::MotionGraph> motion_;
  std::vector<graph::Event> events_;
  int frames_ = 0;
};

/// Draws and writes all that was asked for. Whoever interrupts it keeps the frames that there are.
void write_clips(const Synth& asked, Outputs& outputs, pipeline::ClipSynthesis& frames,
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
  return {{"patches_per_frame", mean(drawn.patches)},
          {"strokes_per_frame", mean(drawn.strokes)},
          {"operators", counts}};
}

/// Figures of a clip made of footage; at a jump_cost of 1 jumps change as much as any frame does.
Json footage_json(const pipeline::FootageSynthesis& drawn) {
  const auto rounded = [](double value) { return std::round(100 * value) / 100; };
  return {{"jump_cost", rounded(drawn.jump_cost())},
          {"plays", drawn.plays()},
          {"plays_back", drawn.plays_back()},
          {"time_spread_frames", rounded(drawn.amplitude())},
          {"copied_share", rounded(drawn.copied_share())}};
}

Json summarise(const Synth& asked, const mcmc::MotionModel& model, const pipeline::ClipSynthesis& frames,
               const Session& session) {
  Json summary = begin_summary("synth", session);
  summary["model"] = {{"folder", asked.model}, {"learned_from_frames", model.frames}};
  summary["model"].update(motion_model_figures(model));
  summary["clip"] = clip_json(asked.output, frames.info(), asked.frames);
  Json edits = edit_json(asked.edit);
  edits["start"] = asked.start;
  summary["options"] = {{"synth",
                         {{"frames", asked.frames},
                          {"fill", pipeline::name(frames.fill_kind())},
                          {"loop", asked.loop ? Json(*asked.loop) : Json(nullptr)}}},
                        {"edit", edits},
                        {"fill", options_json(asked.fill)}};
  summary["synthesis"] =
      frames.footage() ? footage_json(*frames.footage()) : statistics_json(*frames.statistics());
  summary["files"] = {{asked.output, "the new clip"}};
  if (!asked.motion.empty()) summary["files"][asked.motion] = "its graphs and their links";
  if (!asked.film.empty()) summary["files"][asked.film] = "the clip, the drawn sketch and the drawn frame";
  if (!asked.overlay.empty()) summary["files"][asked.overlay] = "the clip under its graph, with its events";
  return summary;
}

void run_synth(Synth asked, Session& session) {
  check(asked);
  io::require_apart({asked.model, asked.edit.birth_map},
                    {{asked.output}, {asked.overlay}, {asked.motion}, {asked.film}});
  require_new({asked.output, asked.overlay, asked.motion, asked.film}, session.common);
  Stages stages;
  stages.begin("read");
  auto opened = pipeline::read_clip_model(asked.model, asked.fill_kind);
  stages.begin("edit");
  const auto& edit = asked.edit.edit;
  const bool carries = asked.fill_kind == pipeline::ModelFill::carried;
  const bool plays = opened.footage && !carries;  // at another speed it is played so, not edited
  if (!plays && !carries) opened = apply_edits(std::move(opened), asked.edit, session);
  stages.begin("synthesize");
  const pipeline::ClipSynthesisOptions options{
      .seed = session.common.seed,
      .fill_kind = asked.fill_kind,
      .start = asked.first(),
      .speed = !plays         ? 1
               : edit.reverse ? -edit.speed
                              : edit.speed,
      .edit = carries ? read_edit(asked.edit, opened.motion) : mcmc::MotionEdit{},
      .loop = asked.loop,
      .fill = asked.fill};
  pipeline::ClipSynthesis frames(opened, options, session.context);
  Outputs outputs(asked, frames);
  write_clips(asked, outputs, frames, session);
  stages.end();
  const auto* const footage = frames.footage();
  session.console.say(
      std::to_string(asked.frames) + " frames drawn from " + asked.model + " into " + asked.output +
      (footage != nullptr
           ? "; " + std::to_string(std::lround(100 * footage->copied_share())) +
                 " % of what moves is as in one frame of the clip" +
                 (footage->plays_back() ? "; it has no like moments and is played back, too" : "")
       : asked.drawn_since.empty() ? ""
                                   : "; " + asked.drawn_since));
  if (!session.common.json) return;
  Json summary = summarise(asked, opened.motion, frames, session);
  end_summary(summary, session, stages);
  session.print(json_text(summary));
}

}  // namespace

void add_synthesis(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "synth", "Draw a new clip from a motion model", R"(
  emberfold synth out/fire/model -o endless.mp4 --loop 120
  emberfold synth out/fire/model -o frames --frames 1000 --fill diffusion --motion new_fire.jsonl)");
  const auto asked = std::make_shared<Synth>();
  command->add_option("MODEL", asked->model, "Read the model from this folder, DIR/model of analyze")
      ->required()
      ->type_name("");
  add_clip_output(*command, asked->output);
  auto* frames = add_number(*command, "--frames", asked->frames, "N", "Draw this many frames");
  command
      ->add_option_function<std::string>(
          "--fill", [asked](const std::string& text) { asked->fill_kind = parse_fill(text); },
          "Use footage, carried strokes, or drawn ones on diffusion, texture, dytex")
      ->type_name("KIND")
      ->default_str("footage");
  command->add_option("--loop", asked->loop, "Draw N frames that repeat without a seam")->type_name("N");
  command->add_option("--motion", asked->motion, "Write the graphs and their links too, as motion.jsonl")
      ->type_name("FILE");
  command->add_option("--overlay", asked->overlay, "Write the clip with its graph and events too")
      ->type_name("OUT");
  command
      ->add_option("--film", asked->film,
                   "Write clip, drawn sketch and drawn frame side by side; .png: six moments")
      ->type_name("OUT");
  const auto settings = add_settings(*command, line);
  command
      ->add_option("--start", asked->start,
                   "Begin as in the clip (data) or as the model usually is (stationary)")
      ->type_name("KIND")
      ->check(CLI::IsMember({"data", "stationary"}).description(""))
      ->default_str(asked->start);
  add_edit_options(*command, asked->edit, settings.get());
  settings->add("fill", asked->fill);
  finish_command(*command, line, asked, run_synth,
                 [asked, frames] { asked->asked_frames = frames->count() > 0; });
}

}  // namespace emberfold::apps
