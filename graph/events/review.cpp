// SPDX-License-Identifier: Apache-2.0
#include "graph/events/review.hpp"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "graph/events/event_family.hpp"

namespace emberfold::graph {

namespace {

// Between an event and the answer that is about it.
constexpr int kSameFrames = 2;
constexpr double kSameEvent = 10;  // px

struct Pair {
  double apart = 0;  ///< 0 where both are the same
  std::size_t event = 0, entry = 0;
};

/// Returns all pairs of an event and an entry that may be the same, the nearest first.
std::vector<Pair> near_pairs(std::span<const Event> events, std::span<const ReviewedEvent> review) {
  std::vector<std::size_t> by_frame(review.size());
  for (std::size_t k = 0; k < by_frame.size(); ++k) by_frame[k] = k;
  std::ranges::stable_sort(by_frame, {}, [&](std::size_t k) { return review[k].event.frame; });
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Event& event = events[i];
    auto at = std::ranges::lower_bound(by_frame, event.frame - kSameFrames, {},
                                       [&](std::size_t k) { return review[k].event.frame; });
    for (; at != by_frame.end() && review[*at].event.frame <= event.frame + kSameFrames; ++at) {
      const ReviewedEvent& other = review[*at];
      const double apart = distance(event.position, other.event.position);
      // An event of the class that was given instead may be the same, too.
      const EventType given = other.answer == Answer::other ? other.type : other.event.type;
      const bool is_alike = detail::family(event.type) == detail::family(other.event.type) ||
                            detail::family(event.type) == detail::family(given);
      if (!is_alike || !(apart <= kSameEvent)) continue;
      const double frames = std::abs(event.frame - other.event.frame);
      const bool is_same_type = event.type == other.event.type || event.type == given;
      pairs.push_back({apart / kSameEvent + frames / kSameFrames + (is_same_type ? 0 : 1), i, *at});
    }
  }
  std::ranges::sort(pairs, {}, [](const Pair& p) { return std::tuple(p.apart, p.event, p.entry); });
  return pairs;
}

std::vector<std::size_t> pair_up(std::span<const Event> events, std::span<const ReviewedEvent> review,
                                 bool with_added) {
  std::vector<std::size_t> entry(events.size(), review.size());
  std::vector<bool> taken(review.size(), false);
  for (const Pair& pair : near_pairs(events, review)) {
    if (entry[pair.event] != review.size() || taken[pair.entry]) continue;
    if (!with_added && review[pair.entry].answer == Answer::added) continue;
    entry[pair.event] = pair.entry;
    taken[pair.entry] = true;
  }
  return entry;
}

}  // namespace

std::optional<Event> told_event(const ReviewedEvent& reviewed) {
  if (reviewed.answer == Answer::none || reviewed.answer == Answer::no) return std::nullopt;
  Event event = reviewed.event;
  event.probability = 1;
  if (reviewed.answer == Answer::other) event.type = reviewed.type;
  return event;
}

std::vector<Event> told_events(std::span<const ReviewedEvent> review) {
  std::vector<Event> events;
  for (const ReviewedEvent& one : review)
    if (auto event = told_event(one)) events.push_back(std::move(*event));
  sort_events(events);
  return events;
}

std::vector<std::size_t> find_answers(std::span<const Event> events, std::span<const ReviewedEvent> review) {
  return pair_up(events, review, false);
}

std::vector<Event> drop_open_events(std::vector<Event> events, std::span<const ReviewedEvent> review) {
  const auto entry = pair_up(events, review, true);
  std::vector<Event> left;
  for (std::size_t k = 0; k < events.size(); ++k)
    if (entry[k] == review.size() || review[entry[k]].answer != Answer::none) left.push_back(events[k]);
  return left;
}

}  // namespace emberfold::graph
