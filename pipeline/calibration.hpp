// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/event_statistics.hpp"
#include "pipeline/analyze.hpp"
#include "sketch/extract.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

/// Maximum number of frames that one round of a calibration draws, and that it examines in the clip.
inline constexpr int kCalibrationFrames = 150;

/// Holds how the clip was analysed, and how clips are drawn from its model.
struct ReadingAndDrawing {
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::RenderOptions look;
};

/// Returns the event statistics of a clip drawn from the model, analysed bottom-up.
/// `frames` ≥ 2 frames from the stationary state are drawn, sketched and matched. Throws core::Cancelled.
mcmc::EventStatistics seen_when_drawn(const mcmc::MotionModel& model, const ReadingAndDrawing& how,
                                      int frames, std::uint64_t seed, const core::Context& context);

/// Corrects a learned model's rates so that drawn clips, once analysed, show the statistics `source`.
/// `source` is of the clip itself, from the same bottom-up analysis. A detector misses some events and
/// reports others that did not happen, which only an analysis of drawn clips can measure (indirect inference:
/// Gourieroux, Monfort & Renault 1993). In each round the clip's number of frames, at most 150, are drawn and
/// analysed; the frequency that the model is balanced to for each kind of event is multiplied by (source /
/// seen)^(1 / round). Number and sizes of strokes are not corrected: undetected strokes are under others, and
/// more strokes would hide more. Returns the statistics of each round before its correction. Throws
/// core::Cancelled.
std::vector<mcmc::EventStatistics> calibrate(mcmc::FitResult& fitted, const mcmc::EventStatistics& source,
                                             const ReadingAndDrawing& how, const CalibrateOptions& options,
                                             std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::pipeline
