// SPDX-License-Identifier: Apache-2.0
#include "graph/io/contact_tables.hpp"

#include <ostream>
#include <string>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::graph {

namespace {

template <class Number>
void add(std::string& text, Number value) {
  if (!text.empty() && text.back() != '\n') text += ',';
  core::append_number(text, value);
}

void add_place(std::string& text, Point place, const Units& units) {
  if (units.um) add(text, place.x * *units.um), add(text, place.y * *units.um);
}

void write_text(std::ostream& out, const std::string& text) {
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("a table could not be written: the stream failed");
}

}  // namespace

void write_contacts(std::ostream& out, const std::vector<CurveContact>& contacts, const Units& units) {
  std::string text = "curve_a,curve_b,crosses,first,last,from_start,to_end,x,y";
  if (units.seconds) text += ",first_s,last_s";
  if (units.um) text += ",x_um,y_um";
  text += '\n';
  for (const CurveContact& contact : contacts) {
    add(text, contact.a.value), add(text, contact.b.value);
    for (const int value : {contact.crosses ? 1 : 0, contact.first, contact.last, contact.from_start ? 1 : 0,
                            contact.to_end ? 1 : 0})
      add(text, static_cast<std::uint32_t>(value));
    add(text, contact.position.x), add(text, contact.position.y);
    if (units.seconds) add(text, contact.first * *units.seconds), add(text, contact.last * *units.seconds);
    add_place(text, contact.position, units);
    text += '\n';
  }
  write_text(out, text);
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
    add(text, static_cast<std::uint32_t>(event.frame));
    add(text, event.position.x), add(text, event.position.y);
    text += ',';
    text += name(event.type);
    text += ',';
    text += name(contacts[k]);
    add(text, event.probability);
    if (units.seconds) add(text, event.frame * *units.seconds);
    add_place(text, event.position, units);
    text += '\n';
  }
  write_text(out, text);
}

}  // namespace emberfold::graph
