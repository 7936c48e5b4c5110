// SPDX-License-Identifier: Apache-2.0
#include "graph/io/contact_tables.hpp"

#include <ostream>
#include <string>

#include "core/error.hpp"
#include "graph/io/table_text.hpp"

namespace emberfold::graph {

namespace {

void add_place(detail::TableLine& line, Point place, const Units& units) {
  if (units.um) line.add(place.x * *units.um), line.add(place.y * *units.um);
}

}  // namespace

void write_contacts(std::ostream& out, const std::vector<CurveContact>& contacts, const Units& units) {
  std::string text = "curve_a,curve_b,crosses,first,last,from_start,to_end,x,y";
  if (units.seconds) text += ",first_s,last_s";
  if (units.um) text += ",x_um,y_um";
  text += '\n';
  for (const CurveContact& contact : contacts) {
    detail::TableLine line(text);
    line.add(contact.a.value), line.add(contact.b.value);
    for (const int value : {contact.crosses ? 1 : 0, contact.first, contact.last, contact.from_start ? 1 : 0,
                            contact.to_end ? 1 : 0})
      line.add(static_cast<std::uint32_t>(value));
    line.add(contact.position.x), line.add(contact.position.y);
    if (units.seconds) line.add(contact.first * *units.seconds), line.add(contact.last * *units.seconds);
    add_place(line, contact.position, units);
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
  if (units.seconds) text += ",time_s";
  if (units.um) text += ",x_um,y_um";
  text += '\n';
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& event = events[k];
    detail::TableLine line(text);
    line.add(static_cast<std::uint32_t>(event.frame));
    line.add(event.position.x), line.add(event.position.y);
    line.add_name(name(event.type)), line.add_name(name(contacts[k]));
    line.add(event.probability);
    if (units.seconds) line.add(event.frame * *units.seconds);
    add_place(line, event.position, units);
    line.end();
  }
  detail::write_table(out, text);
}

void write_topology(std::ostream& out, std::span<const TopologyChange> changes, const Units& units) {
  std::string text = "frame,change,contact,x,y,tips,branches,components,loops,length";
  if (units.seconds) text += ",time_s";
  if (units.um) text += ",x_um,y_um,length_um";
  text += '\n';
  for (const TopologyChange& change : changes) {
    detail::TableLine line(text);
    line.add(static_cast<std::uint32_t>(change.frame));
    line.add_name(name(change.change)), line.add_name(name(change.contact));
    line.add(change.position.x), line.add(change.position.y);
    for (const int value : {change.tips, change.branches, change.components, change.loops})
      line.add_name(std::to_string(value));
    line.add(change.length);
    if (units.seconds) line.add(change.frame * *units.seconds);
    add_place(line, change.position, units);
    if (units.um) line.add(change.length * *units.um);
    line.end();
  }
  detail::write_table(out, text);
}

}  // namespace emberfold::graph
