// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/sampled.hpp"

#include <ctime>

#include "core/clip.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/multi_chain.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "pipeline/readings.hpp"

namespace emberfold::figures {

namespace {

double since(std::clock_t begin) {
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace

Found matched_events(const EventClip& clip, int flicker) {
  const std::clock_t begin = std::clock();
  graph::MatchOptions options;
  options.flicker = flicker;
  auto motion = graph::match(clip.sketch, options);
  Found found{graph::stroke_events(motion), 0, 0, 0, {}};
  const auto sway = mcmc::fit(motion).model.displacement;
  found.a1 = sway.a1, found.a2 = sway.a2;
  found.seconds = since(begin);
  found.sketch = std::move(motion.sketch);
  return found;
}

std::optional<Found> sampled_events(const EventClip& clip) {
  core::Clip frames;
  frames.info.width = clip.sketch.width, frames.info.height = clip.sketch.height;
  frames.info.channels = 1, frames.info.depth = CV_32F, frames.info.white = 255;
  frames.frames.assign(clip.frames.begin(), clip.frames.end());
  core::ClipSource source(frames);
  const pipeline::StartOptions options;
  const auto sketches = pipeline::sketch_starts(source, {}, options, 1, {});
  const std::clock_t begin = std::clock();
  const auto starts = pipeline::match_starts(sketches, {}, options, {});
  auto sampled = mcmc::sample_chains(starts, {}, 1, {});
  auto motion = sampled.last.front();
  auto events = pipeline::event_posterior(source, motion);
  pipeline::weigh_by_samples(sampled.last, events);
  Found found{std::move(events), 0, 0, 0, {}};
  found.a1 = sampled.fitted.model.displacement.a1, found.a2 = sampled.fitted.model.displacement.a2;
  found.seconds = since(begin);
  found.sketch = std::move(motion.sketch);
  return found;
}

}  // namespace emberfold::figures
