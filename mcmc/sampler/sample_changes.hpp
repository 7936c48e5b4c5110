// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "mcmc/sampler/change_field.hpp"
#include "mcmc/sampler/sampler_run.hpp"

namespace emberfold::mcmc {

/// Which changes happened, as draws from their posterior tell.
struct SampledChanges {
  std::vector<double> probabilities;  ///< of each change: the share of the draws in which it happened
  SamplerRun run;
};

/// Samples which changes of a clip happened, by four chains of 60 and 200 sweeps of moves
/// (detail::change_moves) from different starts: the likelier reading of each change, none, and all of them.
/// Their density is the changes' log odds at the rates about them less the costs of lives
/// (detail::LifeCosts). The rates are learned in the first 60 sweeps by stochastic approximation EM (Delyon,
/// Lavielle & Moulines 1999). A change that is unlikelier than e⁻⁶ at these rates is left out of the moves,
/// and has the probability that its log odds say. A clip played backwards has the same draws. The same bytes
/// at any number of threads. Throws core::InputError as ChangeField::validate() does; core::Cancelled.
/// O(sweeps · changes · strands of a life).
SampledChanges sample_changes(const ChangeField& field, std::uint64_t seed,
                              const core::Context& context = {});

}  // namespace emberfold::mcmc
