// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/event_statistics.hpp"
#include "sketch/extract.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

struct CalibrateOptions {
  int calibrate = 2;  ///< 0…20 rounds; 0: rates stay as they were learned from the graphs

  void validate() const;
};

/// How the clip was read, and how clips are drawn from its model.
struct ReadingAndDrawing {
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::RenderOptions look;
};

/// What a clip drawn from the model shows to whoever analyses it, bottom-up: `frames` ≥ 2 frames from its
/// stationary state are drawn, sketched and matched. Throws core::Cancelled.
mcmc::EventStatistics seen_when_drawn(const mcmc::MotionModel& model, const ReadingAndDrawing& how,
                                      int frames, std::uint64_t seed, const core::Context& context);

/// Corrects the rates of a learned model until clips drawn from it show to a bottom-up analysis what the clip
/// itself, `source`, showed to one: a detector misses some of what happens in graphs and makes up other
/// things, and only what is drawn tells how much (indirect inference: Gourieroux, Monfort & Renault 1993). In
/// each round as many frames as the clip has, at most 150, are drawn and analysed; the frequency of each kind
/// of event that the model is balanced to is multiplied by (source / seen)^(1 / round). How many strokes
/// there are and how large is left alone: what is not seen of them lies under others, and more would hide
/// more. Returns what each round saw before its correction. Throws core::Cancelled.
std::vector<mcmc::EventStatistics> calibrate(mcmc::FitResult& fitted, const mcmc::EventStatistics& source,
                                             const ReadingAndDrawing& how, const CalibrateOptions& options,
                                             std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::pipeline
