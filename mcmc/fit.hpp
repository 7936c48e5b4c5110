// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/motion_model.hpp"

namespace emberfold::mcmc {

struct FitOptions {
  std::uint64_t seed = 1;  ///< of the simulated clips that balance births and deaths
  void validate() const;
};

struct FitResult {
  MotionModel model;
  std::vector<std::string> notes;  ///< a line for everything that was not taken as measured: an unstable fit, too little data
  core::Status status = core::Status::done;
};

/// Learns Θ from a matched clip.
FitResult fit(const graph::MotionGraph& motion, const FitOptions& options = {}, const core::Context& context = {});

}  // namespace emberfold::mcmc
