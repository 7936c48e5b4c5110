// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/event_rates.hpp"
#include "graph/events/events.hpp"
#include "graph/events/review.hpp"

namespace emberfold::pipeline {

/// Events after a review.
struct ReviewedClip {
  /// All events, sorted: those answered, with probability 1 or 0 and the class given, those added, and the
  /// others, inferred anew.
  std::vector<graph::Event> events;
  std::vector<graph::Event> asked;                    ///< the events before the review
  std::size_t yes = 0, no = 0, other = 0, added = 0;  ///< answers used
  std::size_t unmatched = 0;  ///< answers "no" to events that are not among those found now
  /// Linear map of an event's log odds inferred from the answers, for births and deaths and for the other
  /// classes: added shift and factor; 0 and 1 without answers.
  std::array<double, 2> shift{0, 0}, slope{1, 1};
  /// Number of events of each class that truly happened, the total last: mean and 90 % interval of the
  /// posterior, including the uncertainty of events without an answer.
  std::array<core::Interval, 7> counts{};
  /// Underlying rates, per frame: the interval also includes that events happen by chance.
  std::array<core::Interval, 7> rates{};
};

/// Takes a review as facts, and infers the other events anew.
/// The answers are matched by graph::find_answers; a fact without an event among `events` is one more event.
/// The others' log odds l become a + b l; a (the base rate's shift, N(0, 1.5²)) and log b (how far the
/// probabilities can be trusted, N(0, 0.4²)) are inferred from the answers, on a grid, separately for births
/// and deaths and for the other classes; the probabilities are those at the mode. The answers may be for any
/// choice of events, for instance by their probabilities. Events that were neither found nor added remain
/// unknown. `gaps`: between frames, ≥ 1. Throws core::InputError for none. O(grid · answers + draws ·
/// events).
ReviewedClip apply_review(std::span<const graph::Event> events, std::span<const graph::ReviewedEvent> review,
                          std::size_t gaps, std::uint64_t seed);

}  // namespace emberfold::pipeline
