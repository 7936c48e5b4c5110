// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/sampled.hpp"

#include <chrono>

#include "graph/match.hpp"
#include "mcmc/fit.hpp"

namespace emberfold::figures {

Found matched_events(const EventClip& clip, int flicker) {
  const auto begin = std::chrono::steady_clock::now();
  graph::MatchOptions options;
  options.flicker = flicker;
  auto motion = graph::match(clip.sketch, options).motion;
  Found found{graph::stroke_events(motion), 0, 0, 0, {}};
  const auto sway = mcmc::fit(motion).model.sway;
  found.a1 = sway.a1, found.a2 = sway.a2;
  found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  found.sketch = std::move(motion.sketch);
  return found;
}

std::optional<Found> sampled_events(const EventClip& /*clip*/) {
  return std::nullopt;
}

}  // namespace emberfold::figures
