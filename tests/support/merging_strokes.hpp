// SPDX-License-Identifier: Apache-2.0
// Two strokes that become one.
#pragma once

#include "graph/events/events.hpp"
#include "tests/support/graphs.hpp"

namespace emberfold::test {

/// Two lines of 10 px in frames 0 and 1, which are one of 30 px in frames 2 and 3.
inline graph::MotionGraph two_become_one() {
  Frame apart, one;
  apart.line({{10, 50}, {15, 50}, {20, 50}});
  apart.line({{30, 50}, {35, 50}, {40, 50}});
  one.line({{10, 50}, {15, 50}, {20, 50}, {25, 50}, {30, 50}, {35, 50}, {40, 50}});
  return graph::identify(motion({apart.graph(), apart.graph(), one.graph(), one.graph()},
                                {{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}},
                                 {{0, 0}, {1, 1}, {2, 2}, {3, 4}, {4, 5}, {5, 6}},
                                 {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {6, 6}}}));
}

inline graph::Event merge_with(double probability) {
  graph::Event event;
  event.frame = 2, event.type = graph::EventType::merge, event.position = {25, 50};
  event.before = {{1}, {2}}, event.after = {{3}};
  event.probability = probability;
  return event;
}

}  // namespace emberfold::test
