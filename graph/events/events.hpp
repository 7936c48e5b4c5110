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

/// Orders events by frame, then type, then position, then strokes.
bool precedes(const Event& a, const Event& b);
/// Sorts events as precedes() orders them.
void sort_events(std::vector<Event>& events);

/// Holds an event and the patches that appeared or vanished.
struct TracedEvent {
  Event event;
  int path_frame = 0;  ///< of the path: `event.frame` of a birth, merge or connect, else the frame before it
  /// Of a birth or death, the longest path of the stroke; else the path that joins the two parts, from the
  /// one to the other. In order, at least one patch.
  std::vector<VertexId> path;
};

/// Finds the events as stroke_events does, each with its patches, in the same order.
std::vector<TracedEvent> trace_stroke_events(const MotionGraph& motion);

/// Finds the events of strokes (connected subgraphs) from links and edges.
/// docs/architecture.md, "What counts as an event", defines the classes. `motion` has its strokes identified.
/// Sorted as by sort_events. Throws InputError as validate() does. O(n log n) in vertices and links.
std::vector<Event> stroke_events(const MotionGraph& motion);

}  // namespace emberfold::graph
