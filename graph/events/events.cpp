// SPDX-License-Identifier: Apache-2.0
#include "graph/events/events.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace emberfold::graph {

namespace {
constexpr std::array<std::string_view, 6> kNames = {"birth", "death",   "split",
                                                    "merge", "connect", "disconnect"};
}

std::span<const EventType> all_event_types() {
  using enum EventType;
  static constexpr std::array kTypes = {birth, death, split, merge, connect, disconnect};
  return kTypes;
}

std::string_view name(EventType type) {
  return kNames[static_cast<std::size_t>(type)];
}

std::optional<EventType> event_type(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<EventType>(found - kNames.begin());
}

bool precedes(const Event& a, const Event& b) {
  return std::tie(a.frame, a.type, a.position.x, a.position.y, a.before, a.after) <
         std::tie(b.frame, b.type, b.position.x, b.position.y, b.before, b.after);
}

void sort_events(std::vector<Event>& events) {
  std::ranges::sort(events, precedes);
}

}  // namespace emberfold::graph
