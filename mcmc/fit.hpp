// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/motion_model.hpp"
#include "mcmc/rates.hpp"

namespace emberfold::mcmc {

struct FitOptions {
  std::uint64_t seed = 1;  ///< of the simulated clips that balance births and deaths
};

struct FitResult {
  MotionModel model;
  OperatorCounts counts;  ///< what the rates were learned from
  std::vector<std::string>
      notes;  ///< a line for everything that was not taken as measured: an unstable fit, too little data
  core::Status status = core::Status::done;
};

/// Learns Θ from a matched clip: the auto-regressions by least squares, the operators' rates from how often
/// they happened and could have, exemplars and one frame's strokes at rest; then births are balanced by
/// simulation so that a synthesized clip keeps its strokes. InputError for fewer than two frames.
/// O(vertices log) and some thousand simulated frames.
FitResult fit(const graph::MotionGraph& motion, const FitOptions& options = {},
              const core::Context& context = {});

}  // namespace emberfold::mcmc
