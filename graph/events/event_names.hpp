// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Kind of contact of two parts that meet or separate: each by its end (tip) or by its side.
enum class Contact : std::uint8_t { none, tip_tip, tip_side, side_side };
/// Returns the name of a contact as files write it; "" of none.
std::string_view name(Contact contact);

/// Finds how the parts of each union or separation meet: ends are looked for within 10 px along the graph, in
/// the frame in which the parts are apart. `events`: any of those that trace_stroke_events finds in `motion`;
/// of births and deaths, and of events that are not found there, the contact is none. In the order of
/// `events`. Throws InputError as validate() does. O(n log n).
std::vector<Contact> event_contacts(const MotionGraph& motion, std::span<const Event> events);

/// Two curves that touch or cross for some time.
struct CurveContact {
  CurveId a, b;             ///< a < b
  int first = 0, last = 0;  ///< frames
  bool crosses = false;     ///< in most of its frames both curves go on to both sides of the place
  Point position;           ///< px, in the first frame
  bool from_start = false, to_end = false;  ///< it is there in the clip's first frame, in its last
  bool operator==(const CurveContact&) const = default;
};
/// Finds where curves touch and cross, and for how long; breaks of up to three frames are bridged.
/// Ordered by first frame, then curves. The curves must be identified. O(n log n).
std::vector<CurveContact> curve_contacts(const MotionGraph& motion);

}  // namespace emberfold::graph
