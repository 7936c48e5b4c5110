// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/events/events.hpp"
#include "tests/bench/events/clips.hpp"

namespace emberfold::figures {

/// Holds the events found in sketches by one method.
struct Found {
  std::vector<graph::Event> events;  ///< of any probability
  double a1 = 0, a2 = 0;             ///< of the sway
  double seconds = 0;                ///< of processor time, all threads; sketching left out
  graph::SketchSequence sketch;      ///< the graphs of the events
};

/// The bottom-up match; states that last no longer than `flicker` frames are noise.
Found matched_events(const EventClip& clip, int flicker);

}  // namespace emberfold::figures
