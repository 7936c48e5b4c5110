// SPDX-License-Identifier: Apache-2.0
#include "apps/sampling.hpp"

#include <utility>

#include "apps/interrupt.hpp"
#include "core/parallel.hpp"
#include "graph/event_posterior.hpp"

namespace emberfold::apps {

Sampled sample_motion(const std::vector<graph::MotionGraph>& starts, const mcmc::InferOptions& options,
                      std::uint64_t seed, const core::Context& context) {
  mcmc::FitOptions fit_options;
  fit_options.seed = seed;
  fit_options.balance = false;
  const auto learned = mcmc::fit(starts.at(0), fit_options, context.with_progress({}));
  Sampled result;
  result.sampler = mcmc::infer(starts, learned.model, mcmc::NotedEvidence{}, options, seed, context);
  if (context.cancelled()) throw Interrupted{};
  const auto& samples = result.sampler.samples;
  std::vector<std::vector<graph::Event>> events(samples.size());
  core::parallel_for(samples.size(), context,
                     [&](std::size_t i) { events[i] = graph::stroke_events(samples[i]); });
  if (context.cancelled()) throw Interrupted{};
  const std::size_t shown = graph::representative(events);
  result.events = graph::pool_events(events, shown);
  result.motion = samples[shown];
  std::vector<graph::MotionGraph> last;
  const std::size_t each = samples.size() / starts.size();
  for (std::size_t k = 0; k < starts.size(); ++k) last.push_back(samples[(k + 1) * each - 1]);
  fit_options.balance = true;
  result.fitted = mcmc::fit(last, fit_options, context);
  if (context.cancelled()) throw Interrupted{};
  return result;
}

}  // namespace emberfold::apps
