// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/simulation/event_statistics.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

struct ClipModel;

/// Holds a pending correction of a model's rates (calibrate): how the clip was analysed, and its statistics.
/// Stored with the model, so that a model's folder alone suffices to correct it. Only clips of drawn strokes
/// need it, so it is not applied before one is drawn.
struct RateCorrection {
  int rounds = 0;  ///< 1…20
  std::uint64_t seed = 1;
  mcmc::EventStatistics source;    ///< of the clip, matched bottom-up
  mcmc::EventStatistics observed;  ///< those to which the rates are balanced (mcmc::FitResult)
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
};

/// Adds a correction to a motion model's archive, in model.json under "correction".
void add_rate_correction(core::ModelArchive& archive, const RateCorrection& correction);
/// Reads a model's pending correction; nothing where there is none. Throws core::IoError for a damaged one.
std::optional<RateCorrection> read_rate_correction(const core::ModelArchive& archive);

/// Applies the model's pending correction, if any, and removes it. Returns the observed statistics of each
/// round. Throws core::Cancelled. Cost: rounds × at most 150 frames drawn, sketched and matched.
std::vector<mcmc::EventStatistics> correct_rates(ClipModel& model, const core::Context& context = {});

}  // namespace emberfold::pipeline
