// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <span>
#include <vector>

#include "graph/events/event_names.hpp"
#include "graph/events/topology_changes.hpp"
#include "graph/io/unit_tables.hpp"

namespace emberfold::graph {

/// Writes contacts.csv: curve_a, curve_b, crosses (1 or 0), first, last (frames), from_start, to_end (1 or
/// 0), x, y (px), and where the units are known first_s, last_s, x_um, y_um. Throws IoError if the stream
/// fails.
void write_contacts(std::ostream& out, const std::vector<CurveContact>& contacts, const Units& units);

/// Writes named_events.csv: frame, x, y (px), type (of the six classes), contact (tip_tip, tip_side,
/// side_side, or nothing), probability, and where the units are known time_s, x_um, y_um. One contact for
/// each event. Throws InputError for another number of contacts, IoError if the stream fails.
void write_named_events(std::ostream& out, std::span<const Event> events, std::span<const Contact> contacts,
                        const Units& units);

/// Writes topology.csv: frame, change, contact, x, y (px), tips, branches, components, loops (what it adds to
/// those), length (px), and where the units are known time_s, x_um, y_um, length_um. Throws IoError if the
/// stream fails.
void write_topology(std::ostream& out, std::span<const TopologyChange> changes, const Units& units);

}  // namespace emberfold::graph
