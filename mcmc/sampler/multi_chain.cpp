// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/multi_chain.hpp"

#include "core/context.hpp"
#include "core/error.hpp"

namespace emberfold::mcmc {

MultiChainResult sample_chains(std::span<const graph::MotionGraph> starts, const InferOptions& options,
                               std::uint64_t seed, const core::Context& context) {
  if (starts.empty()) throw core::InputError("sampling: there is no start");
  MultiChainResult result;
  const MotionModel learned = fit(starts.front(), {seed, false}, context.with_progress({})).model;
  result.sampler = infer(starts, learned, SketchEvidence{}, options, seed, context);
  const auto each = result.sampler.samples.size() / static_cast<std::size_t>(result.sampler.chains);
  for (std::size_t k = 0; k < starts.size(); ++k)
    result.last.push_back(result.sampler.samples[(k + 1) * each - 1]);
  result.fitted = fit(result.last, {seed, true}, context);
  context.check();
  return result;
}

}  // namespace emberfold::mcmc
