// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/clip_statistics.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Options of fit().
struct FitOptions {
  std::uint64_t seed = 1;  ///< of the simulated clips that calibrate the rates
  bool calibrate = true;   ///< false: rates as observed, for models that are not drawn from
};

/// Holds a learned model and the observations that it was learned from.
struct FitResult {
  MotionModel model;
  OperatorCounts counts;     ///< what the rates were learned from
  EventStatistics observed;  ///< statistics of the clip, to which the rates are calibrated
  std::array<RateInterval, 6> events_per_frame{};          ///< RateEstimate::events_per_frame, uncalibrated
  std::array<RateInterval, kSizeClasses> death_by_size{};  ///< RateEstimate::death_by_size, uncalibrated
  /// One line for each number that was not taken as measured: an unstable fit, too little data.
  std::vector<std::string> notes;
};

/// Learns Θ from a clip's matched graph.
/// Auto-regressions are those of the greatest likelihood; rates come from counts of events and of sites. The
/// rates are then calibrated by simulation, so that a drawn clip keeps its number of strokes. Throws
/// core::InputError for fewer than two frames; core::Cancelled. O(vertices log vertices) and some thousand
/// simulated frames.
FitResult fit(const graph::MotionGraph& motion, const FitOptions& options = {},
              const core::Context& context = {});

}  // namespace emberfold::mcmc
