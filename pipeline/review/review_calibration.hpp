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

/// Events in the light of a review.
struct ReviewedClip {
  /// All events, sorted: those answered with probability 1 or 0 and the class that was given, those added,
  /// and the others, each inferred anew.
  std::vector<graph::Event> events;
  std::vector<graph::Event> asked;                    ///< the events as they were found
  std::size_t yes = 0, no = 0, other = 0, added = 0;  ///< answers that were taken
  std::size_t unmatched = 0;  ///< answers "no" to events that are not among those found now
  /// Of births and deaths, and of the other classes: log odds that the answers add to an event's, and what
  /// they multiply them by; 0 and 1 without answers.
  std::array<double, 2> shift{0, 0}, slope{1, 1};
  /// How many events of each class truly happened, and of all in the last place: mean and 90 % interval of
  /// the posterior, which holds what is not known of the events without an answer.
  std::array<core::Interval, 7> counts{};
  /// The rates behind these, a frame: the interval also holds that events happen by chance.
  std::array<core::Interval, 7> rates{};
};

/// Takes a review as facts, and infers the other events anew.
/// The answers are matched by graph::find_answers; a fact without an event among `events` is one more event.
/// The others' log odds l become a + b l; a (the base rate's, N(0, 1.5²)) and log b (how far the
/// probabilities can be trusted, N(0, 0.4²)) are inferred from the answers, on a grid, for births and deaths
/// and for the other classes apart; their probabilities are those at its mode. The answers may be of any
/// choice of events, by their probabilities for instance. Nothing is known of events that were neither found
/// nor added. `gaps`: between frames, ≥ 1. Throws core::InputError for none. O(grid · answers + draws ·
/// events).
ReviewedClip apply_review(std::span<const graph::Event> events, std::span<const graph::ReviewedEvent> review,
                          std::size_t gaps, std::uint64_t seed);

}  // namespace emberfold::pipeline
