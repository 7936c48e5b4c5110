// SPDX-License-Identifier: Apache-2.0
#include "pipeline/analyze.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "core/error.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "graph/matching/time_reversal.hpp"
#include "mcmc/sampler/multi_chain.hpp"
#include "pipeline/background_texture.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "sketch/background/static_pixels.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kLikely = 0.5;  // least probability of reported events

void check_two_frames(const std::string& clip, std::int64_t frames) {
  if (frames >= 2) return;
  if (frames <= 0) throw core::IoError(clip + " holds no frame");
  throw core::IoError(clip + " holds one frame; motion needs at least two ('emberfold sketch' takes one)");
}

void check_options(const AnalyzeOptions& options) {
  options.sketch.validate();
  options.match.validate();
  options.fill.validate();
  options.starts.validate();
  options.infer.validate();
  options.calibrate.validate();
  if (options.bottom_up && options.sample)
    throw core::InputError("AnalyzeOptions.bottom_up and sample exclude each other");
  if (options.curve_events && options.sample)
    throw core::InputError("AnalyzeOptions.curve_events and sample exclude each other");
  if (options.texture < 0 || options.texture > 500)
    throw core::InputError("AnalyzeOptions.texture is " + std::to_string(options.texture) +
                           "; allowed is 0 (none) to 500");
}

/// Names the curves of the motion graph.
void group_curves(Analysis& analysis, core::StageClock& clock, const core::Context& context) {
  clock.begin("curves");
  auto grouped = graph::identify_curves(std::move(analysis.motion), context);
  analysis.motion = std::move(grouped.motion);
  analysis.joints = std::move(grouped.joints);
}

/// Finds the events of the matched clip, of strokes or of curves as `options` ask.
std::vector<graph::Event> find_events(core::FrameSource& source, const graph::SketchSequence& sketch,
                                      const AnalyzeOptions& options, const graph::MotionGraph& motion,
                                      core::StageClock& clock, const core::Context& context) {
  clock.begin("events");
  const bool of_curves = options.curve_events;
  auto read = of_curves ? graph::curves_as_strokes(motion) : motion;
  if (options.bottom_up) return graph::stroke_events(read);
  // Matched backwards, velocities that are carried on decide otherwise where the match is in doubt.
  auto backwards = graph::reverse_time(
      graph::match(graph::reverse_time(sketch), options.match, context.with_progress({})));
  if (of_curves)
    backwards = graph::curves_as_strokes(graph::identify_curves(std::move(backwards), context).motion);
  return event_posterior(source, std::array{std::move(read), std::move(backwards)}, context);
}

/// Finds graphs and events, and learns the motion model, from the sketches of the clip.
void infer_motion(core::FrameSource& source, const StartSketches& sketches, const AnalyzeOptions& options,
                  Analysis& analysis, mcmc::FitResult& fitted, core::StageClock& clock,
                  const core::Context& context) {
  clock.begin("match");
  if (!options.sample) {
    analysis.motion = graph::match(sketches.clip.sketch, options.match, context);
    group_curves(analysis, clock, context);
    analysis.all_events = find_events(source, sketches.clip.sketch, options, analysis.motion, clock, context);
    clock.begin("learn");
    fitted = mcmc::fit(analysis.motion, {options.seed, true}, context);
  } else {
    const auto starts = match_starts(sketches, options.match, options.starts, context);
    clock.begin("sample");
    auto sampled =
        mcmc::sample_chains(starts, backward_readings(options.starts), options.infer, options.seed, context);
    analysis.motion = std::move(sampled.motion);
    analysis.all_events = std::move(sampled.events);
    fitted = std::move(sampled.fitted);
    analysis.sampled = std::move(sampled.sampler);
    group_curves(analysis, clock, context);
    clock.begin("learn");
  }
  if (options.review) {
    const std::size_t gaps = analysis.motion.sketch.frames.size() - 1;
    analysis.reviewed = apply_review(analysis.all_events, *options.review, gaps, options.seed);
    analysis.all_events = analysis.reviewed->events;
  }
  std::ranges::copy_if(analysis.all_events, std::back_inserter(analysis.events),
                       [](const graph::Event& event) { return event.probability >= kLikely; });
}

/// Corrects the model's rates by what is seen in clips drawn from it.
std::optional<Calibration> calibrate_rates(const StartSketches& sketches, const sketch::RenderOptions& look,
                                           const AnalyzeOptions& options, const Analysis& analysis,
                                           mcmc::FitResult& fitted, core::StageClock& clock,
                                           const core::Context& context) {
  if (options.calibrate.calibrate == 0) return std::nullopt;
  clock.begin("calibrate");
  std::optional<graph::MotionGraph> matched;
  if (options.sample) matched = graph::match(sketches.clip.sketch, options.match, context.with_progress({}));
  const auto& motion = matched ? *matched : analysis.motion;
  Calibration result{mcmc::event_statistics(motion, graph::stroke_events(motion)), {}};
  const ReadingAndDrawing how{options.sketch, options.match, look};
  result.rounds = calibrate(fitted, result.source, how, options.calibrate, options.seed, context);
  return result;
}

/// Learns the texture between the strokes into the model; nothing where the clip is none to learn from.
std::optional<LearnedTexture> learn_texture(core::FrameSource& source, const graph::SketchSequence& sketch,
                                            int components, ClipModel& model, const core::Context& context) {
  BackgroundTextureOptions options;
  options.components = components;
  try {
    auto learned = learn_background_texture(source, sketch.frames, options, context);
    for (const auto& note : learned.notes) context.warn("texture: " + note);
    const LearnedTexture figures{learned.texture.components(), learned.hidden, learned.texture.r};
    model.texture = std::move(learned.texture);
    return figures;
  } catch (const core::InputError& error) {
    context.warn("no texture between the strokes: " + std::string(error.what()));
    return std::nullopt;
  }
}

}  // namespace

Analysis analyze(core::FrameSource& source, const AnalyzeOptions& options, const core::Context& context) {
  check_options(options);
  Analysis analysis;
  core::StageClock clock;
  clock.begin("sketch");
  if (source.info().frames) check_two_frames(options.clip, *source.info().frames);
  StartOptions starts = options.starts;
  if (!options.sample) starts.chains = 1;
  auto sketches = sketch_starts(source, options.sketch, starts, options.seed, context);
  check_two_frames(options.clip, static_cast<std::int64_t>(sketches.clip.sketch.frames.size()));
  if (options.keep_sketch) analysis.sketched = sketches.clip;
  mcmc::FitResult fitted;
  infer_motion(source, sketches, options, analysis, fitted, clock, context);
  const auto& sketch = analysis.motion.sketch;
  ClipModel& model = analysis.model;
  model.background = sketch::estimate_background(sketches.clip.grounds);
  model.background.static_pixels = sketch::find_static_pixels(source, context);
  const double gradient = sketch::measure_clip_flank_gradient(source, sketch, context).mean();
  model.sharpening = fit_sharpening(fitted.model, model.background, gradient, options.seed, context);
  const auto look = sketch::apply_sharpening(render_options(fitted.model, model.background, options.fill),
                                             model.sharpening);
  analysis.calibration = calibrate_rates(sketches, look, options, analysis, fitted, clock, context);
  analysis.rates = fitted.events_per_frame;
  model.motion = std::move(fitted.model);
  auto residual = measure_residual(source, sketch.frames,
                                   render_options(model.motion, model.background, options.fill), context);
  if (!residual.empty()) model.residual = std::move(residual);
  for (const auto& note : fitted.notes) context.warn("model: " + note);
  clock.begin("footage");
  model.footage = gather_footage(source, context);
  if (options.texture > 0) {
    clock.begin("texture");
    analysis.texture = learn_texture(source, sketch, options.texture, model, context);
  }
  clock.end();
  analysis.stages = clock.ended();
  return analysis;
}

}  // namespace emberfold::pipeline
