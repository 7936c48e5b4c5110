// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

/// A move to check: any function like Propose, so that a wrong one can be checked too.
using CheckedMove = std::function<std::optional<double>(StateChange& change, ChoiceSource& draws, int frame)>;

/// Holds the largest errors over every draw of every move from every state.
struct RatioReport {
  std::size_t states = 0, transitions = 0;
  bool complete = true;  ///< all states that the moves reach were visited
  /// Largest |claimed − enumerated| log of π(x′) q(x′ → x) / π(x) q(x → x′). Infinite where there is no way
  /// back.
  double worst_ratio = 0;
  /// Largest |π(x) K(x, x′) − π(x′) K(x′, x)|; π is normalised over the states, K is the kernel with
  /// acceptance.
  double worst_balance = 0;
  /// Largest |Σ of the steps' gains − difference of the whole density|, nats.
  double worst_gain = 0;
  std::size_t classes = 0;  ///< communicating classes of the states
  bool restored = true;     ///< every undone move left the state as it was
};

/// Enumerates the states that moves reach from `start` (at most `most`) and checks their ratios.
/// All outcomes of all draws of each move in each frame are followed with their probabilities; a draw of
/// `normal` is its mean, with the density there. A claimed ratio must be that of the sums over all draws that
/// lead from one state to the other. For models of some thousand states. O(states · outcomes · nodes).
/// all draws that lead from one state to the other. O(states · outcomes · nodes).
RatioReport check_ratios(const HiddenGraph& start, const Density& density,
                         const std::vector<CheckedMove>& moves, std::size_t most = 20000);

}  // namespace emberfold::mcmc
