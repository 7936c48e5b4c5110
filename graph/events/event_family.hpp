// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "graph/events/events.hpp"

namespace emberfold::graph::detail {

/// Groups of event classes that are easily taken for each other.
/// Reversing time swaps birth with death, and unite with separate.
enum class Family : std::uint8_t { birth, death, unite, separate };

/// Returns the family of an event class.
inline Family family(EventType type) {
  switch (type) {
    case EventType::birth:
      return Family::birth;
    case EventType::death:
      return Family::death;
    case EventType::merge:
    case EventType::connect:
      return Family::unite;
    case EventType::split:
    case EventType::disconnect:
      break;
  }
  return Family::separate;
}

/// Returns whether strokes become one (merge, connect).
inline bool is_union(EventType type) {
  return family(type) == Family::unite;
}
/// Returns whether strokes come apart (split, disconnect).
inline bool is_separation(EventType type) {
  return family(type) == Family::separate;
}

}  // namespace emberfold::graph::detail
