// SPDX-License-Identifier: Apache-2.0
#include "pipeline/analyze.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>

#include "core/error.hpp"
#include "core/freed_memory.hpp"
#include "core/stage_clock.hpp"
#include "core/text/format_number.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "pipeline/figures/figures.hpp"
#include "pipeline/footage/footage.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "pipeline/inference/first_look.hpp"
#include "pipeline/inference/lasting_patches.hpp"
#include "pipeline/stages/analysis_stages.hpp"
#include "sketch/background/static_pixels.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

namespace {

void check_two_frames(const std::string& clip, std::int64_t frames) {
  if (frames >= 2) return;
  if (frames <= 0) throw core::IoError(clip + " holds no frame");
  throw core::IoError(clip + " holds one frame; motion needs at least two ('emberfold sketch' takes one)");
}

void check_options(const AnalyzeOptions& options) {
  options.sketch.validate();
  options.match.validate();
  if (!(options.least_probability >= 0 && options.least_probability <= 1))
    throw core::InputError("AnalyzeOptions.least_probability is " +
                           std::to_string(options.least_probability) + "; allowed is 0 to 1");
}

/// Names the curves of the motion graph.
void group_curves(Analysis& analysis, const core::Context& context) {
  auto grouped = graph::identify_curves(std::move(analysis.motion), context);
  analysis.motion = std::move(grouped.motion);
  analysis.joints = std::move(grouped.joints);
  analysis.joints.shrink_to_fit();
}

/// Finds the events of the matched clip, of strokes or of curves as `options` ask.
std::vector<graph::Event> find_events(core::FrameSource& source, const AnalyzeOptions& options,
                                      const graph::MotionGraph& motion, core::StageClock& clock,
                                      const core::Context& context) {
  clock.begin("events");
  core::return_freed_memory();
  const bool of_curves = options.curve_events;
  const auto of_topology = [&](std::vector<graph::Event> events) {
    if (of_curves)
      std::erase_if(events, [&](const auto& event) { return graph::changes_names_alone(motion, event); });
    return events;
  };
  auto read = of_curves ? graph::curves_as_strokes(motion) : motion;
  if (options.bottom_up) return of_topology(graph::stroke_events(read));
  return of_topology(weighed_events(source, read, context));
}

bool holds_figures(const Figures& figures) {
  return std::ranges::any_of(figures.motion.sketch.frames, [](const auto& graph) { return !graph.empty(); });
}

/// Finds graphs and events from the sketch of the clip, at whose cuts nothing happens.
void infer_motion(core::FrameSource& source, const graph::SketchSequence& sketch, Figures figures,
                  const AnalyzeOptions& options, Analysis& analysis, core::StageClock& clock,
                  const core::Context& context) {
  clock.begin("match");
  core::return_freed_memory();
  analysis.motion = graph::match(sketch, options.match, context);
  clock.begin("curves");
  group_curves(analysis, context);
  analysis.all_events = find_events(source, options, analysis.motion, clock, context);
  const std::size_t of_lines = analysis.all_events.size();
  if (holds_figures(figures)) {
    add_figures(analysis.motion, analysis.all_events, std::move(figures));
    group_curves(analysis, context);
  }
  if (options.bottom_up) return;
  disbelieve_cuts(analysis.all_events, analysis.cuts);
  clock.begin("sample");
  const auto& motion = analysis.motion;
  analysis.sampled = sample_events(options.curve_events ? graph::curves_as_strokes(motion) : motion,
                                   analysis.all_events, of_lines, analysis.cuts, options.seed, context);
  graph::sort_events(analysis.all_events);
}

/// Leaves out the joints of curves that their frame does not have.
void remove_lost_joints(const graph::SketchSequence& sketch, std::vector<graph::CurveJoint>& joints) {
  std::vector<std::set<graph::CurveId>> there(sketch.frames.size());
  for (std::size_t t = 0; t < there.size(); ++t)
    for (const graph::Vertex& vertex : sketch.frames[t].vertices()) there[t].insert(vertex.curve);
  std::erase_if(joints, [&](const graph::CurveJoint& joint) {
    const auto& curves = there[static_cast<std::size_t>(joint.frame)];
    return !curves.contains(joint.a) || !curves.contains(joint.b);
  });
}

/// Chooses the events to report and, where they are weighed, makes the motion graph agree with them.
void settle_events(Analysis& analysis, const AnalyzeOptions& options) {
  const auto contacts = graph::event_contacts(
      options.curve_events ? graph::curves_as_strokes(analysis.motion) : analysis.motion,
      analysis.all_events);
  if (!options.bottom_up && !options.curve_events) {
    settle_graph(analysis.motion, analysis.all_events, analysis.cuts, options.least_probability);
    remove_lost_joints(analysis.motion.sketch, analysis.joints);
  }
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (analysis.all_events[k].probability >= options.least_probability) {
      analysis.events.push_back(analysis.all_events[k]);
      analysis.contacts.push_back(contacts[k]);
    }
}

std::string words_of(const std::vector<int>& cuts) {
  std::string frames;
  for (const int cut : cuts) frames += (frames.empty() ? "" : ", ") + std::to_string(cut);
  return "the picture changes at frame" + std::string(cuts.size() > 1 ? "s " : " ") + frames +
         " (a cut, black frames or a flash); strokes that end or begin there are not counted as events";
}

std::string words_of(const ClearerChannel& clearer) {
  constexpr std::array kNames = {"red", "green", "blue"};
  const std::string channel = std::to_string(clearer.channel);
  return std::string("strokes are followed in brightness; things in this clip differ from their ground ") +
         (clearer.times < 100 ? core::fixed_text(clearer.times, 1) + " times" : std::string("far")) +
         " more in " + kNames.at(static_cast<std::size_t>(clearer.channel)) + ", which '--channel " +
         channel + "' reads alone";
}

/// Finds motion and events, or reads those that are kept; the motion model is learned where it is not kept.
void find_motion(core::FrameSource& source, const graph::SketchSequence& sketch,
                 const AnalyzeOptions& options, const AnalysisStages* stages, bool has_model,
                 Analysis& analysis, mcmc::FitResult& fitted, core::StageClock& clock,
                 const core::Context& context) {
  auto kept = stages != nullptr ? stages->read_motion(context) : std::nullopt;
  if (kept) {
    analysis.motion = std::move(kept->motion);
    analysis.joints = std::move(kept->joints);
    analysis.all_events = std::move(kept->all_events);
    analysis.cuts = std::move(kept->cuts);
    analysis.sampled = std::move(kept->sampled);
  } else {
    clock.begin("carry");
    FirstLook look = look_over(source, context.with_progress({}));
    analysis.cuts = std::move(look.cuts);
    if (look.clearer) context.warn(words_of(*look.clearer));
    graph::SketchSequence filled = add_lasting_patches(source, sketch, context);
    Figures figures;
    if (options.figures && !options.bottom_up && !options.curve_events) {
      clock.begin("figures");
      figures = find_figures(source, filled, context);
    }
    if (holds_figures(figures)) filled = without_outlines(filled, figures.motion.sketch);
    infer_motion(source, filled, std::move(figures), options, analysis, clock, context);
    if (stages != nullptr)
      stages->keep_motion(
          {analysis.motion, analysis.joints, analysis.all_events, analysis.cuts, analysis.sampled});
  }
  if (!analysis.cuts.empty()) context.warn(words_of(analysis.cuts));
  if (options.review) {
    const std::size_t gaps = analysis.motion.sketch.frames.size() - 1;
    analysis.reviewed = apply_review(analysis.all_events, *options.review, gaps, options.seed);
    analysis.all_events = analysis.reviewed->events;
  }
  clock.begin("learn");
  settle_events(analysis, options);
  if (stages != nullptr && stages->on_events) stages->on_events(analysis, source.info());
  core::return_freed_memory();
  // A believed stroke may be in pieces, which the model takes as strokes.
  if (!has_model) fitted = mcmc::fit(graph::identify(analysis.motion), {options.seed, true}, context);
  core::return_freed_memory();
}

/// Learns everything that new clips are drawn with. `fitted`: how the strokes move.
LearnedModel learn_model(core::FrameSource& source, sketch::Background background,
                         const AnalyzeOptions& options, const Analysis& analysis, mcmc::FitResult fitted,
                         core::StageClock& clock, const core::Context& context) {
  LearnedModel learned;
  ClipModel& model = learned.model;
  model.background = std::move(background);
  model.background.static_pixels = sketch::find_static_pixels(source, context);
  core::return_freed_memory();
  const double gradient = sketch::measure_clip_flank_gradient(source, analysis.motion.sketch, context).mean();
  model.sharpening = fit_sharpening(fitted.model, model.background, gradient, options.seed, context);
  core::return_freed_memory();
  learned.rates = fitted.events_per_frame;
  learned.notes = std::move(fitted.notes);
  model.motion = std::move(fitted.model);
  clock.begin("footage");
  core::return_freed_memory();
  model.footage = gather_footage(source, analysis.motion, context);
  return learned;
}

}  // namespace

std::optional<Quality> quality(std::string_view name) {
  if (name == "draft") return Quality::draft;
  if (name == "normal") return Quality::normal;
  return std::nullopt;
}

void set_quality(AnalyzeOptions& options, Quality quality) {
  if (quality == Quality::draft) options.bottom_up = true;
}

Analysis analyze(core::FrameSource& source, const AnalyzeOptions& options, const core::Context& context,
                 const AnalysisStages* stages) {
  check_options(options);
  Analysis analysis;
  core::StageClock clock;
  clock.begin("sketch");
  if (source.info().frames) check_two_frames(options.clip, *source.info().frames);
  SketchedClip sketched = stages != nullptr ? stages->sketch(source, options.sketch, context)
                                            : sketch_clip(source, options.sketch, context);
  check_two_frames(options.clip, static_cast<std::int64_t>(sketched.sketch.frames.size()));
  if (options.keep_sketch) analysis.sketched = sketched;
  auto learned = stages != nullptr ? stages->read_model() : std::nullopt;
  sketch::Background background;
  if (!learned) background = sketch::estimate_background(sketched.grounds);
  sketched.grounds = {};  // they grow with the clip, and nothing else needs them
  mcmc::FitResult fitted;
  find_motion(source, sketched.sketch, options, stages, learned.has_value(), analysis, fitted, clock,
              context);
  if (!learned) {
    learned =
        learn_model(source, std::move(background), options, analysis, std::move(fitted), clock, context);
    if (stages != nullptr) stages->keep_model(*learned);
  }
  for (const auto& note : learned->notes) context.warn("model: " + note);
  analysis.model = std::move(learned->model);
  analysis.rates = learned->rates;
  clock.end();
  analysis.stages = clock.ended();
  return analysis;
}

}  // namespace emberfold::pipeline
