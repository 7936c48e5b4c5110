// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace emberfold::mcmc {

/// Holds one number of every sweep of every chain, burn-in first, for plots and diagnostics.
struct Trace {
  std::string name;                         ///< "log density", "births", …
  std::vector<std::vector<double>> chains;  ///< [chain][sweep]
};

/// Counts a move's proposals over all chains.
struct MoveSum {
  std::string name;
  double tried = 0, accepted = 0;
};

/// Tells how a sampler's chains ran.
struct SamplerRun {
  int chains = 0;
  int burn_in = 0;  ///< number of the traces' first values
  std::vector<Trace> traces;
  std::vector<MoveSum> moves;
};

}  // namespace emberfold::mcmc
