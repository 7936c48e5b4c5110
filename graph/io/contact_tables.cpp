// SPDX-License-Identifier: Apache-2.0
#include "graph/io/contact_tables.hpp"

#include <ostream>
#include <string>

#include "core/error.hpp"
#include "graph/io/table_text.hpp"

namespace emberfold::graph {

void write_contacts(std::ostream& out, const std::vector<CurveContact>& contacts, const Units& units) {
  std::string text = "curve_a,curve_b,crosses,first,last,from_start,to_end,x,y";
  detail::end_head(text, units, ",first_s,last_s", ",x_um,y_um");
  for (const CurveContact& contact : contacts) {
    detail::TableLine line(text, units);
    line.add(contact.a.value), line.add(contact.b.value);
    for (const int value : {contact.crosses ? 1 : 0, contact.first, contact.last, contact.from_start ? 1 : 0,
                            contact.to_end ? 1 : 0})
      line.add(static_cast<std::uint32_t>(value));
    line.add_place(contact.position);
    line.add_time(contact.first), line.add_time(contact.last);
    line.add_place_um(contact.position);
    line.end();
  }
  detail::write_table(out, text);
}

void write_named_events(std::ostream& out, std::span<const Event> events, std::span<const Contact> contacts,
                        const Units& units) {
  if (events.size() != contacts.size())
    throw core::InputError("named events: " + std::to_string(contacts.size()) + " contacts for " +
                           std::to_string(events.size()) + " events");
  std::string text = "frame,x,y,type,contact,probability";
  detail::end_head(text, units, ",time_s", ",x_um,y_um");
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& event = events[k];
    detail::TableLine line(text, units);
    line.add(static_cast<std::uint32_t>(event.frame));
    line.add_place(event.position);
    line.add_name(name(event.type)), line.add_name(name(contacts[k]));
    line.add(event.probability);
    line.add_time(event.frame), line.add_place_um(event.position);
    line.end();
  }
  detail::write_table(out, text);
}

void write_topology(std::ostream& out, std::span<const TopologyChange> changes, const Units& units) {
  std::string text = "frame,change,contact,x,y,tips,branches,components,loops,length";
  detail::end_head(text, units, ",time_s", ",x_um,y_um,length_um");
  for (const TopologyChange& change : changes) {
    detail::TableLine line(text, units);
    line.add(static_cast<std::uint32_t>(change.frame));
    line.add_name(name(change.change)), line.add_name(name(change.contact));
    line.add_place(change.position);
    for (const int value : {change.tips, change.branches, change.components, change.loops})
      line.add_name(std::to_string(value));
    line.add(change.length);
    line.add_time(change.frame), line.add_place_um(change.position), line.add_length_um(change.length);
    line.end();
  }
  detail::write_table(out, text);
}

}  // namespace emberfold::graph
