// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/event_census.hpp"

namespace emberfold::mcmc {

struct FitOptions {
  std::uint64_t seed = 1;  ///< of the simulated clips that balance births and deaths
  bool balance = true;     ///< false: rates as they were seen, for whoever will not draw from the model
};

struct FitResult {
  MotionModel model;
  OperatorCounts counts;                             ///< what the rates were learned from
  Census shown;                                      ///< what the clip shows, which the rates are balanced to
  std::array<RateInterval, 6> a_frame{};             ///< RateEstimate::a_frame: before balance
  std::array<RateInterval, kSizes> death_by_size{};  ///< likewise
  std::vector<std::string>
      notes;  ///< a line for everything that was not taken as measured: an unstable fit, too little data
};

/// Learns Θ from samples of the posterior of one clip's matched graph: the M step of Monte Carlo EM (Wei &
/// Tanner 1990). Auto-regressions are of the greatest mean likelihood; the operators' rates come from how
/// often they happened and could have, on average; exemplars and one frame's strokes at rest are the last
/// sample's; then births are balanced by simulation so that a synthesized clip keeps its strokes. InputError
/// for no sample, samples of unlike sizes or numbers of frames, or fewer than two frames. O(vertices log) and
/// some thousand simulated frames.
FitResult fit(std::span<const graph::MotionGraph> samples, const FitOptions& options = {},
              const core::Context& context = {});

/// From a clip matched once: one sample.
FitResult fit(const graph::MotionGraph& motion, const FitOptions& options = {},
              const core::Context& context = {});

}  // namespace emberfold::mcmc
