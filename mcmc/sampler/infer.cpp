// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/infer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "mcmc/sampler/candidate_weights.hpp"
#include "mcmc/sampler/chain.hpp"
#include "mcmc/sampler/prior.hpp"
#include "mcmc/sampler/sufficient_statistics.hpp"

namespace emberfold::mcmc {

namespace {

constexpr int kSamples = 5;       // states that a chain keeps, evenly spread over its sweeps
constexpr double kProposals = 8;  // moves for each candidate in a sweep

/// Step sizes of the stochastic approximation: whole steps, then ever smaller ones (Delyon, Lavielle,
/// Moulines 1999).
double step_size(int sweep, int burn_in) {
  const int whole = burn_in / 2;
  return sweep < whole ? 1 : std::pow(sweep - whole + 1, -0.7);
}

const HiddenGraph& state_of(const HiddenGraph& state) {
  return state;
}
const HiddenGraph& state_of(const Chain& chain) {
  return chain.state();
}

/// Returns the mean statistics of some states or chains under a θ.
template <class Item>
SufficientStatistics mean_statistics(std::span<const Item> items, const SamplerParameters& theta) {
  SufficientStatistics mean;
  double count = 0;
  for (const Item& item : items)
    mean.blend(sufficient_statistics(state_of(item), Density(theta)), 1 / ++count);
  return mean;
}

/// Returns θ as the starts have it; the displacement's law is the prior's.
SamplerParameters first_theta(std::span<const HiddenGraph> starts, const SamplerParameters& prior,
                              double area) {
  SamplerParameters theta = most_likely_parameters(mean_statistics(starts, prior), prior, area);
  theta.displacement = prior.displacement;
  return widen_spreads(theta);
}

/// The chains from the starts and perhaps one from nothing, of one θ, which is learned from the former.
class Chains {
 public:
  Chains(std::vector<HiddenGraph> states, std::size_t learned_from, const SamplerParameters& prior,
         std::uint64_t seed)
      : learned_from_(learned_from), prior_(prior), area_(double(states[0].width()) * states[0].height()) {
    const auto theta = first_theta(std::span<const HiddenGraph>(states).first(learned_from), prior, area_);
    chains_.reserve(states.size());
    for (HiddenGraph& state : states)
      chains_.emplace_back(std::move(state), theta, seed, static_cast<std::uint32_t>(chains_.size()));
  }
  void sweep(int number, const InferOptions& options, const core::Context& context) {
    for (Chain& chain : chains_) chain.sweep(kProposals, context);
    if (number < options.burn_in) learn(step_size(number, options.burn_in));
  }
  [[nodiscard]] std::size_t size() const { return chains_.size(); }
  Chain& operator[](std::size_t k) { return chains_[k]; }

 private:
  /// Takes a step of the stochastic approximation.
  void learn(double size) {
    const auto learned_from = std::span<const Chain>(chains_).first(learned_from_);
    sums_.blend(mean_statistics(learned_from, chains_[0].theta()), size);
    const SamplerParameters theta = widen_spreads(most_likely_parameters(sums_, prior_, area_));
    for (Chain& chain : chains_) chain.set_theta(theta);
  }

  std::size_t learned_from_;
  SamplerParameters prior_;
  double area_;
  std::vector<Chain> chains_;
  SufficientStatistics sums_;
};

/// Numbers recorded of a chain after each sweep; the last six count its events of strokes.
constexpr std::array<const char*, 12> kTraces = {
    "log posterior", "patches", "edges",  "links",  "a1",       "a2",
    "births",        "deaths",  "splits", "merges", "connects", "disconnects"};
std::array<double, kTraces.size()> trace_values(Chain& chain, const graph::MotionGraph& drawn) {
  const HiddenGraph& g = chain.state();
  double patches = 0, edges = 0, links = 0;
  for (int t = 0; t < g.frames(); ++t)
    for (const Index i : g.active(t)) {
      patches += 1;
      edges += static_cast<double>(g[i].edges.size()) / 2, links += static_cast<double>(g[i].next.size());
    }
  std::array<double, kTraces.size()> values = {
      chain.log_density(),          patches, edges, links, chain.theta().displacement.a1,
      chain.theta().displacement.a2};
  for (const graph::Event& event : graph::stroke_events(drawn))
    ++values.at(6 + static_cast<std::size_t>(event.type));
  return values;
}

void count_moves(Chains& chains, InferResult& result) {
  for (const Move& move : moves()) result.moves.push_back({std::string(move.name), 0, 0, 0});
  for (std::size_t k = 0; k < chains.size(); ++k)
    for (std::size_t m = 0; m < result.moves.size(); ++m) {
      const MoveCount& count = chains[k].counts()[m];
      result.moves[m].tried += count.tried, result.moves[m].evaluated += count.evaluated;
      result.moves[m].accepted += count.accepted;
    }
  for (const MoveSum& move : result.moves) result.proposals += move.evaluated;
}

/// The same candidates, all off.
HiddenGraph without_patches(HiddenGraph state) {
  for (int t = 0; t < state.frames(); ++t)
    while (!state.active(t).empty()) {
      const Index i = state.active(t).front();
      while (!state[i].next.empty()) state.unlink(i, state[i].next[0]);
      while (!state[i].prev.empty()) state.unlink(state[i].prev[0], i);
      while (!state[i].edges.empty()) state.remove_edge(i, state[i].edges[0]);
      state.deactivate(i);
    }
  return state;
}

/// Of `sweeps` after burn-in the last of each part is a sample.
bool is_sample(int sweep, const InferOptions& options) {
  const int kept = sweep - options.burn_in + 1, samples = std::min(kSamples, options.sweeps);
  return kept > 0 && kept * samples / options.sweeps > (kept - 1) * samples / options.sweeps;
}

}  // namespace

void InferOptions::validate() const {
  core::check_fields("InferOptions", *this);
}

InferResult infer(std::span<const graph::MotionGraph> starts, const MotionModel& learned,
                  const Evidence& evidence, const InferOptions& options, std::uint64_t seed,
                  const core::Context& context) {
  options.validate();
  std::vector<HiddenGraph> states = hidden_graphs(starts, {});
  weigh_candidates(states, evidence, context);
  for (HiddenGraph& state : states) apply_maps(state, learned);
  if (options.from_nothing) states.push_back(without_patches(states[0]));
  const std::clock_t begun = std::clock();
  Chains chains(std::move(states), starts.size(), prior_parameters(starts[0], learned), seed);
  InferResult result;
  result.burn_in = options.burn_in, result.chains = static_cast<int>(chains.size());
  for (const char* name : kTraces)
    result.traces.push_back({name, std::vector<std::vector<double>>(chains.size())});
  std::vector<std::vector<graph::MotionGraph>> samples(chains.size());
  const int sweeps = options.burn_in + options.sweeps;
  for (int n = 0; n < sweeps; ++n) {
    context.report("sample", double(n) / sweeps);
    chains.sweep(n, options, context);
    for (std::size_t k = 0; k < chains.size(); ++k) {
      auto drawn = motion_graph(chains[k].state(), starts[0].sketch.fps);
      const auto values = trace_values(chains[k], drawn);
      for (std::size_t i = 0; i < values.size(); ++i) result.traces[i].chains[k].push_back(values[i]);
      if (is_sample(n, options)) samples[k].push_back(std::move(drawn));
    }
  }
  for (auto& of_chain : samples) std::ranges::move(of_chain, std::back_inserter(result.samples));
  count_moves(chains, result);
  result.seconds = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  return result;
}

}  // namespace emberfold::mcmc
