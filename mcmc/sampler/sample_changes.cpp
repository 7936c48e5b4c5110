// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/sample_changes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "core/math/log_odds.hpp"
#include "core/parallel.hpp"
#include "mcmc/sampler/change_chain.hpp"
#include "mcmc/sampler/change_rates.hpp"

namespace emberfold::mcmc {

namespace {

using detail::ChangeChain;

constexpr int kBurnIn = 60, kDraws = 200;  // sweeps
constexpr std::uint32_t kChains = 4;
constexpr double kStepExponent = 0.7;  // of learning: Delyon, Lavielle & Moulines allow (½, 1]
constexpr double kClosed = -6;         // log odds below which a change is left out
constexpr double kSurest = 12;         // log odds: what the images or a review say counts for no more
constexpr std::uint32_t kStream = 0x6368;

/// Returns the changes in an order that a clip played backwards has, too.
std::vector<std::uint32_t> order_of(const ChangeField& field) {
  std::vector<std::uint32_t> order(field.changes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t k) {
    const Change& change = field.changes[k];
    return std::tuple(change.log_odds, change.place.x, change.place.y);
  });
  return order;
}

/// Returns the field with its changes in this order.
ChangeField ordered(const ChangeField& field, std::span<const std::uint32_t> order) {
  ChangeField result{field.strands, {}, field.gaps};
  std::vector<std::uint32_t> at(order.size());
  for (const std::uint32_t k : order) {
    at[k] = static_cast<std::uint32_t>(result.changes.size());
    result.changes.push_back(field.changes[k]);
    double& odds = result.changes.back().log_odds;
    odds = std::clamp(odds, -kSurest, kSurest);
  }
  for (Gap& gap : result.gaps) gap = {at[gap.death], at[gap.birth]};
  std::ranges::sort(result.gaps, {}, [](const Gap& gap) {
    return std::tuple(std::min(gap.death, gap.birth), std::max(gap.death, gap.birth));
  });
  return result;
}

ChangeState start_of(const ChangeField& field, std::span<const double> log_odds, std::uint32_t chain) {
  ChangeState state{{}, std::vector<bool>(field.gaps.size())};
  for (const double odds : log_odds)
    state.happened.push_back(odds > kClosed && (chain == 2 || (chain != 1 && odds > 0)));
  return state;
}

std::vector<bool> open_changes(std::span<const double> log_odds) {
  std::vector<bool> open;
  for (const double odds : log_odds) open.push_back(odds > kClosed);
  return open;
}

/// The chains of a field, and what is noted of them.
class Sampler {
 public:
  Sampler(const ChangeField& field, std::uint64_t seed, const core::Context& context)
      : field_(field),
        seed_(seed),
        context_(context),
        rates_(field),
        times_(kChains, std::vector<double>(field.changes.size())) {
    rates_.learn_alone();
    for (std::uint32_t c = 0; c < kChains; ++c)
      chains_.emplace_back(field, start_of(field, rates_.log_odds(), c));
    run_.chains = kChains, run_.burn_in = kBurnIn;
    for (const char* name :
         {"log density", "births", "deaths", "splits", "merges", "connects", "disconnects"})
      run_.traces.push_back({name, std::vector<std::vector<double>>(kChains)});
  }

  SampledChanges sample() {
    std::vector<double> happened(field_.changes.size());
    std::vector<bool> open = open_changes(rates_.log_odds());
    reopen(open);
    for (int sweep = 0; sweep < kBurnIn + kDraws; ++sweep) {
      context_.report("sample", double(sweep) / (kBurnIn + kDraws));
      if (sweep <= kBurnIn) {
        auto now = open_changes(rates_.log_odds());
        if (now != open) reopen(open = std::move(now));
      }
      core::parallel_for(kChains, context_, [&](std::size_t c) { advance(c, sweep); });
      if (sweep >= kBurnIn) continue;
      const double step = sweep < kBurnIn / 2 ? 1 : std::pow(sweep - kBurnIn / 2 + 1, -kStepExponent);
      for (std::size_t k = 0; k < happened.size(); ++k)
        happened[k] += step * (mean_of(k, open[k]) - happened[k]);
      rates_.learn(happened);
    }
    SampledChanges sampled;
    for (std::size_t k = 0; k < happened.size(); ++k) {
      double times = 0.5;  // half a draw for and against it: draws alone make nothing certain
      for (const auto& of_chain : times_) times += of_chain[k];
      sampled.probabilities.push_back(open[k] ? times / (kChains * kDraws + 1) : alone(k));
    }
    count_moves();
    sampled.run = std::move(run_);
    return sampled;
  }

 private:
  [[nodiscard]] double alone(std::size_t k) const { return core::from_log_odds(rates_.log_odds()[k]); }
  [[nodiscard]] double mean_of(std::size_t k, bool is_open) const {
    if (!is_open) return alone(k);
    const auto count =
        std::ranges::count_if(chains_, [&](const ChangeChain& c) { return c.state().happened[k]; });
    return double(count) / kChains;
  }
  void reopen(const std::vector<bool>& open) {
    moves_ = detail::change_moves(field_, open);
    for (ChangeChain& chain : chains_) chain.open(open);
  }
  void advance(std::size_t c, int sweep) {
    core::Rng rng(seed_, {kStream, static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(sweep)});
    ChangeChain& chain = chains_[c];
    chain.sweep(moves_, rates_.log_odds(), rng);
    std::array<double, 7> numbers{};
    numbers[0] = chain.log_density(rates_.log_odds());
    for (std::size_t k = 0; k < field_.changes.size(); ++k) {
      if (!chain.state().happened[k]) continue;
      ++numbers.at(1 + static_cast<std::size_t>(field_.changes[k].type));
      if (sweep >= kBurnIn) ++times_[c][k];
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) run_.traces[i].chains[c].push_back(numbers.at(i));
  }
  void count_moves() {
    for (std::size_t i = 0; i < detail::kMoveNames.size(); ++i) {
      MoveSum sum{std::string(detail::kMoveNames.at(i)), 0, 0};
      for (const ChangeChain& chain : chains_)
        sum.tried += chain.tried().at(i), sum.accepted += chain.accepted().at(i);
      run_.moves.push_back(std::move(sum));
    }
  }

  const ChangeField& field_;
  std::uint64_t seed_;
  const core::Context& context_;
  detail::ChangeRates rates_;
  std::vector<detail::ChangeMove> moves_;  // of the open changes
  std::vector<ChangeChain> chains_;
  std::vector<std::vector<double>> times_;  // that each change happened, of each chain
  SamplerRun run_;
};

}  // namespace

SampledChanges sample_changes(const ChangeField& field, std::uint64_t seed, const core::Context& context) {
  field.validate();
  const auto order = order_of(field);
  const ChangeField sorted = ordered(field, order);
  SampledChanges sampled = Sampler(sorted, seed, context).sample();
  std::vector<double> probabilities(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) probabilities[order[i]] = sampled.probabilities[i];
  sampled.probabilities = std::move(probabilities);
  return sampled;
}

}  // namespace emberfold::mcmc
