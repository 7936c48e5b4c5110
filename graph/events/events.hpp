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

enum class EventType : std::uint8_t { birth, death, split, merge, connect, disconnect };

/// Returns all classes in the order of their values.
std::span<const EventType> all_event_types();
std::string_view name(EventType type);
std::optional<EventType> event_type(std::string_view name);

/// A change of topology between frames `frame` − 1 and `frame`.
struct Event {
  int frame = 0;
  EventType type = EventType::birth;
  Point position;
  double probability = 1;
  std::vector<SubgraphId> before, after;  ///< the strokes concerned
  bool operator==(const Event&) const = default;
};

/// Orders events by frame, then type, then place.
void sort_events(std::vector<Event>& events);

/// The events of strokes (connected subgraphs), read off links and edges: see docs/architecture.md, "What
/// counts as an event". Ordered by frame, then type, then place. The motion graph has its strokes identified.
/// O(n log n) in vertices and links.
std::vector<Event> stroke_events(const MotionGraph& motion);

/// The events of single patches: births and deaths of vertices without links, splits and merges of vertices
/// with several (one event for each such vertex); connect and disconnect where an edge between two vertices
/// that both go on 1–1 appears or goes. `before` and `after` name the strokes.
std::vector<Event> patch_events(const MotionGraph& motion);

}  // namespace emberfold::graph
