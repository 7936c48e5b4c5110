// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/infer.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>

#include "core/error.hpp"
#include "mcmc/sampler/candidate_weights.hpp"
#include "mcmc/sampler/chain.hpp"
#include "mcmc/sampler/prior.hpp"
#include "mcmc/sampler/sufficient_statistics.hpp"

namespace emberfold::mcmc {

namespace {

void check(bool holds, const char* name, double value, const std::string& allowed) {
  if (!holds)
    throw core::InputError(std::string("infer: ") + name + " is " + std::to_string(value) + ", allowed is " +
                           allowed);
}

/// Step sizes of the stochastic approximation: whole steps, then ever smaller ones (Delyon, Lavielle,
/// Moulines 1999).
double step_size(int sweep, int burn_in) {
  const int whole = burn_in / 2;
  return sweep < whole ? 1 : std::pow(sweep - whole + 1, -0.7);
}

/// A chain with its statistics and θ, or a ladder of tempered chains.
class TemperedChain {
 public:
  TemperedChain(HiddenGraph state, const SamplerParameters& prior, std::uint64_t seed, std::uint32_t number,
                int tempering_levels)
      : prior_(prior), area_(double(state.width()) * state.height()), seed_(seed), number_(number) {
    const SamplerParameters theta = widen_spreads(
        with_displacement(most_likely_parameters(sufficient_statistics(state, Density(prior)), prior, area_),
                          prior.displacement));
    for (int r = 0; r < tempering_levels; ++r)
      ladder_.emplace_back(state, theta, seed, number * 16 + static_cast<std::uint32_t>(r), std::exp2(-r));
  }

  void sweep(int number, const InferOptions& options, const core::Context& context) {
    for (Chain& chain : ladder_) chain.sweep(options.proposals, context);
    exchange(number);
    if (number < options.burn_in) {
      sums_.blend(sufficient_statistics(state(), Density(ladder_[0].theta())),
                  step_size(number, options.burn_in));
      const SamplerParameters theta = widen_spreads(most_likely_parameters(sums_, prior_, area_));
      for (Chain& chain : ladder_) chain.set_theta(theta);
    }
  }
  [[nodiscard]] const HiddenGraph& state() const { return ladder_[0].state(); }
  Chain& chain() { return ladder_[0]; }
  void add_counts(std::vector<MoveSum>& sums) const {
    for (const Chain& chain : ladder_)
      for (std::size_t m = 0; m < sums.size(); ++m) {
        sums[m].tried += chain.counts()[m].tried, sums[m].evaluated += chain.counts()[m].evaluated;
        sums[m].accepted += chain.counts()[m].accepted;
      }
  }

 private:
  static SamplerParameters with_displacement(SamplerParameters theta, const Autoregression& displacement) {
    theta.displacement = displacement;
    return theta;
  }
  /// Exchanges the states of neighbours on the ladder, even and odd ones in turn.
  void exchange(int sweep) {
    for (std::size_t r = static_cast<std::size_t>(sweep % 2); r + 1 < ladder_.size(); r += 2) {
      Chain &low = ladder_[r], &high = ladder_[r + 1];
      const double gain = (low.power() - high.power()) * (high.evidence() - low.evidence());
      core::Rng rng(
          seed_, {static_cast<std::uint32_t>(sweep), static_cast<std::uint32_t>(r), (3U << 24U) | number_});
      if (std::log1p(-rng.uniform()) < gain) low.swap_states(high);
    }
  }

  SamplerParameters prior_;
  double area_;
  std::uint64_t seed_;
  std::uint32_t number_;
  std::vector<Chain> ladder_;
  SufficientStatistics sums_;
};

/// Numbers recorded of a chain after each sweep.
constexpr std::array<const char*, 8> kTraces = {"log posterior", "patches", "edges", "links", "a1", "a2",
                                                "deaths",        "births"};
std::array<double, kTraces.size()> trace_values(Chain& chain) {
  const HiddenGraph& g = chain.state();
  double patches = 0, edges = 0, links = 0, deaths = 0, births = 0;
  for (int t = 0; t < g.frames(); ++t)
    for (const Index i : g.active(t)) {
      patches += 1;
      edges += static_cast<double>(g[i].edges.size()) / 2, links += static_cast<double>(g[i].next.size());
      deaths += t + 1 < g.frames() && g[i].next.empty(), births += t > 0 && g[i].prev.empty();
    }
  return {chain.log_density(),           patches, edges, links, chain.theta().displacement.a1,
          chain.theta().displacement.a2, deaths,  births};
}

}  // namespace

void InferOptions::validate() const {
  check(sweeps >= 1 && sweeps <= 100000, "sweeps", sweeps, "1…100000");
  check(burn_in >= 1 && burn_in <= 100000, "burn_in", burn_in, "1…100000");
  check(samples >= 1 && samples <= sweeps, "samples", samples, "1 to the number of sweeps");
  check(proposals >= 0.01 && proposals <= 1000, "proposals", proposals, "0.01…1000");
  check(tempering_levels >= 1 && tempering_levels <= 16, "rungs", tempering_levels, "1…16");
}

InferResult infer(std::span<const graph::MotionGraph> starts, const MotionModel& learned,
                  const Evidence& evidence, const InferOptions& options, std::uint64_t seed,
                  const core::Context& context) {
  options.validate();
  if (starts.empty()) throw core::InputError("infer: there is no start");
  for (const auto& start : starts)
    if (start.sketch.width != starts[0].sketch.width || start.sketch.height != starts[0].sketch.height ||
        start.sketch.frames.size() != starts[0].sketch.frames.size())
      throw core::InputError("infer: the starts are of different clips");
  InferResult result;
  result.burn_in = options.burn_in;
  for (const char* name : kTraces) result.traces.push_back({name, {}});
  for (const Move& move : moves()) result.moves.push_back({std::string(move.name), 0, 0, 0});
  const int sweeps = options.burn_in + options.sweeps;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    HiddenGraph state = hidden_graph(starts[k], {}, {});
    weigh_candidates(state, evidence, context);
    apply_maps(state, learned);
    const std::clock_t begun = std::clock();
    TemperedChain sampler(std::move(state), prior_parameters(starts[k], learned), seed,
                          static_cast<std::uint32_t>(k), options.tempering_levels);
    for (Trace& trace : result.traces) trace.chains.emplace_back();
    for (int n = 0; n < sweeps; ++n) {
      context.report("sample", (static_cast<double>(k) + double(n) / sweeps) / double(starts.size()));
      sampler.sweep(n, options, context);
      const auto values = trace_values(sampler.chain());
      for (std::size_t i = 0; i < values.size(); ++i) result.traces[i].chains.back().push_back(values[i]);
      const int kept = n - options.burn_in + 1;  // of `sweeps`, the last of each part is a sample
      if (kept > 0 && kept * options.samples / options.sweeps > (kept - 1) * options.samples / options.sweeps)
        result.samples.push_back(motion_graph(sampler.state(), starts[k].sketch.fps));
    }
    sampler.add_counts(result.moves);
    result.seconds += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
    ++result.chains;
  }
  for (const MoveSum& move : result.moves) result.proposals += move.evaluated;
  return result;
}

}  // namespace emberfold::mcmc
