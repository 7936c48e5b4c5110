// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/sampled.hpp"

#include <ctime>

#include "graph/match.hpp"
#include "mcmc/fit.hpp"

namespace emberfold::figures {

Found matched_events(const EventClip& clip, int flicker) {
  const std::clock_t begin = std::clock();
  graph::MatchOptions options;
  options.flicker = flicker;
  auto motion = graph::match(clip.sketch, options).motion;
  Found found{graph::stroke_events(motion), 0, 0, 0, {}};
  const auto sway = mcmc::fit(motion).model.sway;
  found.a1 = sway.a1, found.a2 = sway.a2;
  found.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  found.sketch = std::move(motion.sketch);
  return found;
}

std::optional<Found> sampled_events(const EventClip& /*clip*/) {
  return std::nullopt;
}

}  // namespace emberfold::figures
