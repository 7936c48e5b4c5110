// SPDX-License-Identifier: Apache-2.0
#include "apps/commands/analysis.hpp"

#include <algorithm>
#include <set>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/summary.hpp"
#include "apps/pictures/pictures.hpp"
#include "apps/pictures/rate_map.hpp"
#include "apps/report/report.hpp"
#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "graph/events/event_score.hpp"
#include "graph/io/motion_io.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/multi_chain.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/residual_texture.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

void write_data(io::OutputFolder& output, const graph::MotionGraph& motion,
                const std::vector<graph::Event>& events, const std::vector<graph::Event>& all_events) {
  output.write("sketch.jsonl", [&](std::ostream& out) { graph::write_sketch(out, motion.sketch); });
  output.write("motion.jsonl", [&](std::ostream& out) { graph::write_motion(out, motion); });
  output.write("events.json", [&](std::ostream& out) { graph::write_events(out, events); });
  output.write("events_all.json", [&](std::ostream& out) { graph::write_events(out, all_events); });
  output.write("events.csv", [&](std::ostream& out) { graph::write_events_csv(out, events); });
  output.write("trajectories.csv", [&](std::ostream& out) { graph::write_trajectories(out, motion); });
  output.write("strokes.csv", [&](std::ostream& out) { graph::write_strokes(out, motion); });
}

Json per_frame_json(const graph::MotionGraph& motion, const std::vector<graph::Event>& events) {
  Json patches = Json::array(), strokes = Json::array();
  std::vector<std::size_t> count(motion.sketch.frames.size());
  for (const auto& graph : motion.sketch.frames) {
    patches.push_back(graph.size());
    strokes.push_back(graph::components(graph).count);
  }
  for (const auto& event : events) ++count.at(static_cast<std::size_t>(event.frame));
  return {{"patches", patches}, {"strokes", strokes}, {"events", count}};
}

/// How the patches of the frames that were drawn again pay, null where there are none.
Json gain_json(const pipeline::GainTotals& gains) {
  if (gains.patches == 0) return nullptr;
  const auto patches = static_cast<double>(gains.patches);
  return {{"mean", std::round(gains.nats / patches * 100) / 100},
          {"positive_share", std::round(static_cast<double>(gains.positive) / patches * 10000) / 10000},
          {"patches", gains.patches}};
}

Json sketch_json(const Json& per_frame, const Pictures& pictures) {
  const auto mean = [](const Json& list) {
    double total = 0;
    for (const auto& value : list) total += value.get<double>();
    return std::round(total / std::max<double>(1, double(list.size())) * 100) / 100;
  };
  std::size_t patches = 0;
  for (const auto& value : per_frame["patches"]) patches += value.get<std::size_t>();
  const Json share = pipeline::spread_json(pictures.share);
  return {{"patches", patches},
          {"patches_per_frame", mean(per_frame["patches"])},
          {"strokes_per_frame", mean(per_frame["strokes"])},
          {"sketchable_share", share.is_null() ? Json(0) : share["mean"]},
          {"psnr", pipeline::spread_json(pictures.psnr)},
          {"coding_gain", gain_json(pictures.gains)}};
}

Json motion_json(const graph::MotionGraph& motion) {
  std::set<std::uint32_t> strokes;
  std::size_t links = 0;
  for (const auto& graph : motion.sketch.frames)
    for (const auto& vertex : graph.vertices()) strokes.insert(vertex.subgraph.value);
  for (const auto& gap : motion.links) links += gap.size();
  return {
      {"strokes", strokes.size()}, {"links", links}, {"trajectories", graph::trajectories(motion).size()}};
}

Json events_json(const std::vector<graph::Event>& events, std::size_t frames) {
  Json classes = Json::object();
  for (const auto type : graph::all_event_types())
    classes[std::string(graph::name(type))] = std::ranges::count(events, type, &graph::Event::type);
  const double per_frame = double(events.size()) / double(std::max<std::size_t>(1, frames - 1));
  return {{"total", events.size()}, {"per_frame", std::round(per_frame * 1000) / 1000}, {"classes", classes}};
}

Json files_json(bool reconstruction) {
  Json files = {{"events.json", "the events of strokes"},
                {"events.csv", "the same as a table"},
                {"events_all.json", "those less probable too"},
                {"motion.jsonl", "graphs and their links, a line a frame"},
                {"sketch.jsonl", "the graphs alone"},
                {"trajectories.csv", "every patch through time"},
                {"model/", "what was learned: 'emberfold synth' draws new clips from it"},
                {"strokes.csv", "every stroke through time"},
                {"birth_map.png", "where strokes are born"},
                {"death_map.png", "where they die"},
                {"overlay.mp4", "the clip with its graph and events"},
                {"matches/", "neighbouring frames, matched"},
                {"summary.json", "all figures"}};
  if (reconstruction) files["reconstruction.avi"] = "the clip drawn from its sketch";
  return files;
}

void need_two_frames(const std::string& clip, std::int64_t frames) {
  if (frames >= 2) return;
  if (frames <= 0) throw core::IoError(clip + " holds no frame");
  throw core::IoError(clip + " holds one frame; motion needs at least two ('emberfold sketch' takes one)");
}

/// Writes the motion model; what was not taken as measured becomes warnings.
void write_fitted(const mcmc::FitResult& fitted, const sketch::Background& ground,
                  const pipeline::ResidualTexture& residual, const sketch::Sharpening& sharpening,
                  io::OutputFolder& output, Session& session) {
  for (const auto& note : fitted.notes) session.warn("model: " + note);
  auto archive = mcmc::to_archive(fitted.model);
  sketch::add_background(archive, ground);
  pipeline::add_residual(archive, residual);
  sketch::add_sharpening(archive, sharpening);
  io::write_model(output, "model", archive);
}

/// Learns what lies between the strokes; null where the clip is none to learn from.
Json learn_texture(core::FrameSource& source, const graph::SketchSequence& sketch, int components,
                   io::OutputFolder& output, Session& session) {
  pipeline::BackgroundTextureOptions options;
  options.components = components;
  try {
    const auto learned = pipeline::learn_background_texture(source, sketch.frames, options, session.context);
    for (const auto& note : learned.notes) session.warn("texture: " + note);
    pipeline::write_background_texture(output, "model", learned);
    return {{"components", learned.texture.components()},
            {"hidden_share", std::round(learned.hidden * 10000) / 10000},
            {"r", learned.texture.r}};
  } catch (const core::InputError& error) {
    session.warn("no texture between the strokes: " + std::string(error.what()));
    return nullptr;
  }
}

std::vector<RateInterval> rates_a_frame(const mcmc::FitResult& fitted) {
  std::vector<RateInterval> rates;
  for (const auto type : graph::all_event_types()) {
    const auto& found = fitted.events_per_frame[static_cast<std::size_t>(type)];
    rates.push_back({std::string(graph::name(type)), found.mean, found.low, found.high, "a frame"});
  }
  return rates;
}

/// Graphs, events and what was learned, from the sketches of the clip.
void infer_motion(const pipeline::StartSketches& sketches, const AnalyzeOptions& options, Analysis& made,
                  Session& session) {
  made.stages.begin("match");
  if (options.bottom_up) {
    auto matched = graph::match(sketches.clip.sketch, options.match, session.context);
    made.motion = std::move(matched.motion);
    made.all_events = graph::stroke_events(made.motion);
    made.stages.begin("learn");
    made.fitted = mcmc::fit(made.motion, {session.common.seed, true}, session.context);
  } else {
    const auto starts = pipeline::match_starts(sketches, options.match, options.starts, session.context);
    made.stages.begin("sample");
    auto sampled = mcmc::sample_chains(starts, pipeline::backward_readings(options.starts), options.infer,
                                       session.common.seed, session.context);
    made.motion = std::move(sampled.motion);
    made.all_events = std::move(sampled.events);
    made.fitted = std::move(sampled.fitted);
    made.sampled = std::move(sampled.sampler);
    made.rates = rates_a_frame(made.fitted);
  }
  std::ranges::copy_if(made.all_events, std::back_inserter(made.events),
                       [](const auto& e) { return e.probability >= 0.5; });
}

Json census_json(const mcmc::EventStatistics& census) {
  Json events = Json::object();
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  for (const auto type : graph::all_event_types())
    events[std::string(graph::name(type))] = rounded(census.events[static_cast<std::size_t>(type)]);
  double strokes = 0;
  for (const double count : census.strokes) strokes += count;
  return {{"patches", rounded(census.patches)}, {"strokes", rounded(strokes)}, {"events", events}};
}

/// Corrects the model's rates by what is seen in clips drawn from it; tells, a frame, what the clip itself
/// shows to the bottom-up analysis, and what they did in each round.
Json calibrate_model(const pipeline::StartSketches& sketches, const sketch::RenderOptions& look,
                     const AnalyzeOptions& options, Analysis& made, const Session& session) {
  if (options.calibrate.calibrate == 0) return nullptr;
  made.stages.begin("calibrate");
  std::optional<graph::MatchResult> matched;
  if (!options.bottom_up)
    matched = graph::match(sketches.clip.sketch, options.match, session.context.with_progress({}));
  const auto& motion = matched ? matched->motion : made.motion;
  const auto source = mcmc::event_statistics(motion, graph::stroke_events(motion));
  const pipeline::ReadingAndDrawing how{options.sketch, options.match, look};
  Json rounds = Json::array();
  for (const auto& seen :
       pipeline::calibrate(made.fitted, source, how, options.calibrate, session.common.seed, session.context))
    rounds.push_back(census_json(seen));
  return {{"source", census_json(source)}, {"rounds", rounds}};
}

}  // namespace

Analysis analyze_clip(const std::string& name, const AnalyzeOptions& options, io::OutputFolder& output,
                      Session& session, const std::optional<std::vector<graph::Event>>& truth,
                      const std::string& shown_name) {
  Analysis made;
  made.clip = shown_name.empty() ? name : shown_name;
  Stages& stages = made.stages;
  stages.begin("sketch");
  const auto source = open_clip(name, options.read, [&](const std::string& text) { session.warn(text); });
  if (source->info().frames) need_two_frames(made.clip, *source->info().frames);
  pipeline::StartOptions starts = options.starts;
  if (options.bottom_up) starts.chains = 1;
  auto sketches =
      pipeline::sketch_starts(*source, options.sketch, starts, session.common.seed, session.context);
  need_two_frames(made.clip, static_cast<std::int64_t>(sketches.clip.sketch.frames.size()));
  if (options.keep_sketch) made.sketched = sketches.clip;
  infer_motion(sketches, options, made, session);
  const auto& motion = made.motion;
  const auto& events = made.events;
  auto ground = sketch::still_background(sketches.clip.grounds);
  ground.backdrop = sketch::find_static_pixels(*source, session.context);
  const double wanted = sketch::clip_flank_gradient(*source, motion.sketch, session.context).mean();
  const auto& sharpening = made.sharpening =
      pipeline::fit_sharpening(made.fitted.model, ground, wanted, session.common.seed, session.context);
  const auto look =
      sketch::sharpened(pipeline::render_options(made.fitted.model, ground, options.fill), sharpening);
  Json calibration = calibrate_model(sketches, look, options, made, session);
  const auto residual = pipeline::measure_residual(
      *source, motion.sketch.frames, pipeline::render_options(made.fitted.model, ground, options.fill),
      session.context);
  write_fitted(made.fitted, ground, residual, sharpening, output, session);
  Json texture;
  if (options.texture > 0) {
    stages.begin("texture");
    texture = learn_texture(*source, motion.sketch, options.texture, output, session);
  }
  stages.begin("write");
  write_data(output, motion, events, made.all_events);

  stages.begin("pictures");
  const PictureOptions picture_options{options.fill, options.reconstruction};
  Pictures pictures = draw_pictures(*source, motion, events, picture_options, output, session);
  if (pictures.not_converged > 0)
    session.warn("the fill stopped before its tolerance in " + std::to_string(pictures.not_converged) +
                 " frames");
  write_png(output, "birth_map.png", draw_rate_map(pictures.mean, birth_map(made.fitted.model), events));
  write_png(output, "death_map.png", draw_rate_map(pictures.mean, death_map(made.fitted.model), events));
  stages.end();

  Json& summary = made.summary = begin_summary("analyze", session);
  summary["clip"] = clip_json(made.clip, source->info(), static_cast<int>(motion.sketch.frames.size()));
  summary["options"] = {{"reading", reading_json(options.read)},
                        {"sketch", options_json(options.sketch)},
                        {"match", options_json(options.match)},
                        {"starts", options_json(options.starts)},
                        {"infer", options_json(options.infer)},
                        {"bottom_up", options.bottom_up},
                        {"calibrate", options_json(options.calibrate)},
                        {"texture", options.texture},
                        {"fill", options_json(options.fill)}};
  Json per_frame = per_frame_json(motion, events);
  summary["sketch"] = sketch_json(per_frame, pictures);
  summary["motion"] = motion_json(motion);
  summary["events"] = events_json(events, motion.sketch.frames.size());
  summary["model"] = motion_model_figures(made.fitted.model);
  summary["calibration"] = std::move(calibration);
  summary["model"]["blur_share"] = std::round(sharpening.blur_share * 1000) / 1000;
  summary["model"]["contrast_gain"] = std::round(sharpening.contrast_gain * 1000) / 1000;
  if (options.texture > 0) summary["model"]["texture"] = std::move(texture);
  if (truth) {
    const graph::ScoreOptions tolerance;
    summary["score"] = score_json(graph::score_events(*truth, events, tolerance));
    summary["score"]["tolerance"] = options_json(tolerance);
  }
  summary["files"] = files_json(options.reconstruction);
  summary["per_frame"] = std::move(per_frame);
  made.report = std::move(pictures.report);
  return made;
}

void finish_analysis(Analysis& made, io::OutputFolder& output, const Session& session) {
  Json& summary = made.summary;
  summary["warnings"] = session.warnings;
  summary["seconds"] = made.stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  made.report.clip = made.clip;
  made.report.command_line = session.command_line;
  made.report.version = kVersion;
  made.report.motion = &made.motion;
  made.report.events = made.events;
  made.report.model = &made.fitted.model;
  if (made.sampled) {
    made.report.sampled = &*made.sampled;
    made.report.all_events = made.all_events;
    made.report.rates = made.rates;
    summary["sampler"] = sampler_json(*made.sampled);
  }
  output.write("report.html", [&](std::ostream& out) { out << make_report(made.report, summary); });
  output.write("summary.json", [&](std::ostream& out) { out << json_text(summary); });
  session.check_stop();
}

}  // namespace emberfold::apps
