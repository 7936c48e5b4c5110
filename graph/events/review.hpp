// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Answer of a person about an event.
enum class Answer : std::uint8_t {
  none,   ///< nothing yet
  yes,    ///< it happened
  no,     ///< it did not
  other,  ///< something of another class happened there
  added,  ///< it happened, and was not among the events that were found
};

/// An event with what a person said of it.
struct ReviewedEvent {
  Event event;  ///< as it was found; as the person told it where it was added
  Answer answer = Answer::none;
  EventType type = EventType::birth;  ///< of `other`, the class that the person gave
  bool operator==(const ReviewedEvent&) const = default;
};

/// Returns the event as the person told it; nothing if it did not happen or was not answered.
std::optional<Event> told_event(const ReviewedEvent& reviewed);

/// Returns what truly happened by a review, each of probability 1, sorted.
std::vector<Event> told_events(std::span<const ReviewedEvent> review);

/// Finds what was said of each of the events: an entry of the review of the same family (birth, death, union,
/// separation; that of the class given instead counts too) within 2 frames and 10 px, one to one, the nearest
/// first. Returns for each event the index of its entry or `review.size()`. Entries that were added have no
/// event. O(n log n) in pairs so near.
std::vector<std::size_t> find_answers(std::span<const Event> events, std::span<const ReviewedEvent> review);

/// Drops the events that a review leaves open: those that lie nearer, in the sense of find_answers, to an
/// entry without an answer than to any with one. A reviewed file scores what is left.
std::vector<Event> drop_open_events(std::vector<Event> events, std::span<const ReviewedEvent> review);

}  // namespace emberfold::graph
