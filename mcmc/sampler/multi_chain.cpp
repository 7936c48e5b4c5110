// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/multi_chain.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "core/context.hpp"
#include "core/error.hpp"
#include "graph/matching/time_reversal.hpp"

namespace emberfold::mcmc {

namespace {

FitOptions fitting(std::uint64_t seed, bool calibrate) {
  FitOptions options;
  options.seed = seed, options.calibrate = calibrate;
  return options;
}

/// Adds the samples, traces and counts of one more chain.
void add(InferResult chain, InferResult& all) {
  if (all.chains == 0) {
    all = std::move(chain);
    return;
  }
  std::ranges::move(chain.samples, std::back_inserter(all.samples));
  for (std::size_t i = 0; i < all.traces.size(); ++i)
    std::ranges::move(chain.traces[i].chains, std::back_inserter(all.traces[i].chains));
  for (std::size_t m = 0; m < all.moves.size(); ++m) {
    all.moves[m].tried += chain.moves[m].tried, all.moves[m].evaluated += chain.moves[m].evaluated;
    all.moves[m].accepted += chain.moves[m].accepted;
  }
  all.chains += chain.chains;
  all.proposals += chain.proposals, all.seconds += chain.seconds;
}

/// Samples a chain from each start, in the time direction in which the start was matched. The two of a pair
/// have the same seed: a reversed clip has the same two chains, in exchanged order.
InferResult sample_readings(const std::vector<graph::MotionGraph>& starts, const std::vector<bool>& backwards,
                            const InferOptions& options, std::uint64_t seed, const core::Context& context) {
  InferResult all;
  std::array<std::optional<MotionModel>, 2> learned;  // of each sense, from the first that has it
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const graph::MotionGraph start = backwards[k] ? graph::reverse_time(starts[k]) : starts[k];
    auto& model = learned.at(backwards[k] ? 1 : 0);
    if (!model) model = fit(start, fitting(seed, false), context.with_progress({})).model;
    const core::Context part = context.with_progress([&](std::string_view stage, double share) {
      context.report(stage, (static_cast<double>(k) + share) / static_cast<double>(starts.size()));
    });
    auto chain = infer({&start, 1}, *model, SketchEvidence{}, options, seed + k / 2, part);
    context.check();
    if (backwards[k])
      for (auto& sample : chain.samples) sample = graph::reverse_time(sample);
    add(std::move(chain), all);
  }
  return all;
}

}  // namespace

MultiChainResult sample_chains(const std::vector<graph::MotionGraph>& starts,
                               const std::vector<bool>& backwards, const InferOptions& options,
                               std::uint64_t seed, const core::Context& context) {
  if (starts.empty() || starts.size() != backwards.size()) {
    throw core::InputError("sampling: " + std::to_string(starts.size()) + " starts of " +
                           std::to_string(backwards.size()) + " readings, allowed are as many, one at least");
  }
  MultiChainResult result;
  result.sampler = sample_readings(starts, backwards, options, seed, context);
  const auto& samples = result.sampler.samples;
  const std::size_t each = samples.size() / starts.size();
  for (std::size_t k = 0; k < starts.size(); ++k) result.last.push_back(samples[(k + 1) * each - 1]);
  result.fitted = fit(result.last, fitting(seed, true), context);
  context.check();
  return result;
}

}  // namespace emberfold::mcmc
