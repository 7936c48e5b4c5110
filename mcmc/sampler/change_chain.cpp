// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/change_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace emberfold::mcmc::detail {

namespace {

/// Returns whether a bridged gap is as it must be: nothing happened at its ends, and no other is bridged
/// there.
bool is_whole(const Gap& gap, const ChangeState& state,
              const std::vector<std::vector<std::uint32_t>>& gaps_of) {
  const auto bridged = [&](std::uint32_t change) {
    return std::ranges::count_if(gaps_of[change], [&](std::uint32_t g) { return state.bridged[g]; });
  };
  return !state.happened[gap.death] && !state.happened[gap.birth] && bridged(gap.death) == 1 &&
         bridged(gap.birth) == 1;
}

std::vector<std::vector<std::uint32_t>> gaps_of_changes(const ChangeField& field) {
  std::vector<std::vector<std::uint32_t>> result(field.changes.size());
  for (std::uint32_t g = 0; g < field.gaps.size(); ++g) {
    result[field.gaps[g].death].push_back(g);
    result[field.gaps[g].birth].push_back(g);
  }
  return result;
}

/// Returns the sum of the log odds of what happened.
double odds_of(const ChangeState& state, std::span<const double> log_odds) {
  double sum = 0;
  for (std::size_t k = 0; k < log_odds.size(); ++k)
    if (state.happened[k]) sum += log_odds[k];
  return sum;
}

}  // namespace

double log_density(const ChangeField& field, std::span<const double> log_odds, const ChangeState& state) {
  const auto gaps_of = gaps_of_changes(field);
  for (std::size_t g = 0; g < field.gaps.size(); ++g)
    if (state.bridged[g] && !is_whole(field.gaps[g], state, gaps_of))
      return -std::numeric_limits<double>::infinity();
  const LifeCosts costs(field, std::vector<bool>(field.changes.size(), true), state);
  return odds_of(state, log_odds) - costs.noted_of_all();
}

ChangeChain::ChangeChain(const ChangeField& field, ChangeState state)
    : field_(field), state_(std::move(state)), gaps_of_(gaps_of_changes(field)) {}

void ChangeChain::open(const std::vector<bool>& changes) {
  for (std::size_t k = 0; k < changes.size(); ++k)
    if (!changes[k]) state_.happened[k] = false;
  costs_.emplace(field_, changes, state_);
}

double ChangeChain::log_density(std::span<const double> log_odds) const {
  return odds_of(state_, log_odds) - costs_->noted_of_all();
}

void ChangeChain::turn(const ChangeMove& move) {
  for (const std::uint32_t k : move.changes) state_.happened[k] = !state_.happened[k];
  if (move.gap) state_.bridged[*move.gap] = !state_.bridged[*move.gap];
}

bool ChangeChain::is_allowed(const ChangeMove& move) const {
  const auto fits = [&](std::uint32_t g) {
    return !state_.bridged[g] || is_whole(field_.gaps[g], state_, gaps_of_);
  };
  return (!move.gap || fits(*move.gap)) && std::ranges::all_of(move.changes, [&](std::uint32_t k) {
           return std::ranges::all_of(gaps_of_[k], fits);
         });
}

void ChangeChain::sweep(std::span<const ChangeMove> moves, std::span<const double> log_odds, core::Rng& rng) {
  for (const ChangeMove& move : moves) {
    const double level = std::log(rng.uniform());
    ++tried_[move.kind];
    double gain = costs_->noted(move.strands);
    for (const std::uint32_t k : move.changes) gain += state_.happened[k] ? -log_odds[k] : log_odds[k];
    if (level >= gain) continue;  // whatever it costs afterwards
    turn(move);
    if (is_allowed(move) && level < gain - costs_->of(move.strands, state_)) {
      costs_->note();
      ++accepted_[move.kind];
    } else {
      turn(move);
    }
  }
}

}  // namespace emberfold::mcmc::detail
