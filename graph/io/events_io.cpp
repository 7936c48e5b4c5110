// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <istream>
#include <ostream>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/event_reading.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/table_text.hpp"
#include "graph/io/unit_tables.hpp"

namespace emberfold::graph {

namespace {

using core::append_number;

void append_ids(std::string& text, const std::vector<SubgraphId>& ids, char separator) {
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (k > 0) text += separator;
    core::append_number(text, ids[k].value);
  }
}

void check_event(const Event& event) {
  const bool good = event.frame >= 0 && std::isfinite(event.position.x) && std::isfinite(event.position.y) &&
                    event.probability >= 0 && event.probability <= 1;
  if (good) return;
  throw core::InputError("writing events: a " + std::string(name(event.type)) + " in frame " +
                         std::to_string(event.frame) +
                         " has a negative frame, a place that is not finite or a probability outside 0 to 1");
}

void write_text(std::ostream& out, const std::string& text) {
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out.flush()) throw core::IoError("events could not be written: the stream failed");
}

}  // namespace

void write_events(std::ostream& out, const std::vector<Event>& events) {
  write_events(out, events, {});
}

void write_events(std::ostream& out, const std::vector<Event>& events, const Units& units) {
  std::string text = "{\"format\":\"emberfold.events\",\"version\":1,";
  if (const auto& from = units.origin.counted_from; !from.empty())
    text += "\"counted_from\":\"" + from + "\",";
  text += "\"events\":[";
  for (const Event& event : events) {
    check_event(event);
    const Point place = units.place(event.position);
    text += text.back() == '[' ? "\n" : ",\n";
    text += "{\"frame\":";
    core::append_number(text, static_cast<std::uint32_t>(event.frame));
    text += ",\"type\":\"";
    text += name(event.type);
    text += "\",\"x\":";
    core::append_number(text, place.x);
    text += ",\"y\":";
    core::append_number(text, place.y);
    text += ",\"probability\":";
    core::append_number(text, event.probability);
    text += ",\"before\":[";
    append_ids(text, event.before, ',');
    text += "],\"after\":[";
    append_ids(text, event.after, ',');
    text += "]}";
  }
  text += "\n]}\n";
  write_text(out, text);
}

void write_events_csv(std::ostream& out, const std::vector<Event>& events) {
  write_events_csv(out, events, {});
}

void write_events_csv(std::ostream& out, const std::vector<Event>& events, const Units& units) {
  std::string text = "frame,type,x,y,probability,before,after";
  detail::end_head(text, units, ",time_s", ",x_um,y_um");
  const auto ids = [](const std::vector<SubgraphId>& list) {
    std::string joined;
    append_ids(joined, list, ';');
    return joined;
  };
  for (const Event& event : events) {
    check_event(event);
    detail::TableLine line(text, units);
    line.add(static_cast<std::uint32_t>(event.frame)), line.add_name(name(event.type));
    line.add_place(event.position), line.add(event.probability);
    line.add_name(ids(event.before)), line.add_name(ids(event.after));
    line.add_time(event.frame), line.add_place_um(event.position);
    line.end();
  }
  write_text(out, text);
}

std::vector<Event> read_events(std::istream& in, std::string_view name) {
  try {
    std::vector<Event> events;
    detail::read_event_list(in, {"emberfold.events"},
                            [&](const nlohmann::json&, Event event) { events.push_back(std::move(event)); });
    return events;
  } catch (const core::IoError& error) {
    throw core::IoError(std::string(name) + ": " + error.what());
  }
}

}  // namespace emberfold::graph
