// SPDX-License-Identifier: Apache-2.0
#include "pipeline/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/context.hpp"
#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "mcmc/simulation/rate_calibration.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/frame_synthesis.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kAtOnce = 8;

/// Multiplies `wanted` by the factor by which too few were seen, as if one more event had been in all.
void correct(double& wanted, double source, double seen, double one, double step) {
  wanted *= std::pow(std::clamp((source + one) / (seen + one), 0.25, 4.0), step);
}

}  // namespace

void CalibrateOptions::validate() const {
  core::check_fields("CalibrateOptions", *this);
}

mcmc::EventStatistics seen_when_drawn(const mcmc::MotionModel& model, const ReadingAndDrawing& how,
                                      int frames, std::uint64_t seed, const core::Context& context) {
  FrameSynthesis drawn(mcmc::Synthesis(model, seed, mcmc::Start::stationary), how.look);
  ClipStrokes strokes(how.look.size, model.fps, how.sketch, how.match);
  for (int done = 0; done < frames; done += kAtOnce)
    strokes.add(bytes_to_levels(drawn.next(std::min(kAtOnce, frames - done), context)), context);
  const auto motion = strokes.motion(context.with_progress({}));
  return mcmc::event_statistics(motion, graph::stroke_events(motion));
}

std::vector<mcmc::EventStatistics> calibrate(mcmc::FitResult& fitted, const mcmc::EventStatistics& source,
                                             const ReadingAndDrawing& how, const CalibrateOptions& options,
                                             std::uint64_t seed, const core::Context& context) {
  std::vector<mcmc::EventStatistics> found;
  mcmc::MotionModel& model = fitted.model;
  if (source.patches <= 0 || model.exemplars.empty()) return found;
  mcmc::EventStatistics wanted = fitted.observed, usual = source;
  reconcile_event_rates(wanted), reconcile_event_rates(usual);
  const int frames = std::clamp(model.frames, 2, kCalibrationFrames);
  const double one = 1.0 / frames;
  for (int round = 0; round < options.calibrate; ++round) {
    context.report("calibrate", double(round) / options.calibrate);
    found.push_back(seen_when_drawn(model, how, frames, seed + static_cast<std::uint64_t>(round), context));
    mcmc::EventStatistics seen = found.back();
    reconcile_event_rates(seen);
    const double step = 1.0 / (1 + round);
    for (std::size_t i = 0; i < wanted.events.size(); ++i)
      correct(wanted.events[i], usual.events[i], seen.events[i], one, step);
    mcmc::calibrate_rates(model, wanted, seed, context.with_progress({}));
    context.check();
  }
  return found;
}

}  // namespace emberfold::pipeline
