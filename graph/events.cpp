// SPDX-License-Identifier: Apache-2.0
#include "graph/events.hpp"

#include <algorithm>
#include <array>

namespace emberfold::graph {

namespace {
constexpr std::array<std::string_view, 6> kNames = {"birth", "death",   "split",
                                                    "merge", "connect", "disconnect"};
}

std::string_view name(EventType type) {
  return kNames[static_cast<std::size_t>(type)];
}

std::optional<EventType> event_type(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<EventType>(found - kNames.begin());
}

}  // namespace emberfold::graph
