// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/matched.hpp"

#include <ctime>

#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"

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

}  // namespace emberfold::figures
