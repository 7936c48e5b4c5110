// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// The six classes of topological events.
enum class EventType : std::uint8_t { birth, death, split, merge, connect, disconnect };

/// Returns all classes in the order of their values.
std::span<const EventType> all_event_types();
/// Returns the name of a class as files write it.
std::string_view name(EventType type);
/// Returns the class of this name, if there is one.
std::optional<EventType> event_type(std::string_view name);

/// A change of topology between frames `frame` − 1 and `frame`.
struct Event {
  int frame = 0;  ///< ≥ 1
  EventType type = EventType::birth;
  Point position;                         ///< px
  double probability = 1;                 ///< 0…1
  std::vector<SubgraphId> before, after;  ///< the strokes concerned
  bool operator==(const Event&) const = default;
};

/// Sorts events by frame, then type, then position, then strokes.
void sort_events(std::vector<Event>& events);

/// Finds the events of strokes (connected subgraphs) from links and edges.
/// docs/architecture.md, "What counts as an event", defines the classes. `motion` has its strokes identified.
/// Sorted as by sort_events. Throws InputError as validate() does. O(n log n) in vertices and links.
std::vector<Event> stroke_events(const MotionGraph& motion);

}  // namespace emberfold::graph
