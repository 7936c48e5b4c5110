// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <istream>
#include <ostream>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/unit_tables.hpp"

namespace emberfold::graph {

namespace {

using core::append_number;
using nlohmann::json;

constexpr std::size_t kLongestFile = std::size_t{1} << 28;  // bytes, 256 MiB: bounds the memory of reading

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
  std::string text = "{\"format\":\"emberfold.events\",\"version\":1,\"events\":[";
  for (const Event& event : events) {
    check_event(event);
    text += text.back() == '[' ? "\n" : ",\n";
    text += "{\"frame\":";
    core::append_number(text, static_cast<std::uint32_t>(event.frame));
    text += ",\"type\":\"";
    text += name(event.type);
    text += "\",\"x\":";
    core::append_number(text, event.position.x);
    text += ",\"y\":";
    core::append_number(text, event.position.y);
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
  if (units.seconds) text += ",time_s";
  if (units.um) text += ",x_um,y_um";
  text += '\n';
  const auto column = [&text](double value) {
    text += ',';
    core::append_number(text, value);
  };
  for (const Event& event : events) {
    check_event(event);
    core::append_number(text, static_cast<std::uint32_t>(event.frame));
    text += ',';
    text += name(event.type);
    for (const double value : {event.position.x, event.position.y, event.probability}) {
      text += ',';
      core::append_number(text, value);
    }
    text += ',';
    append_ids(text, event.before, ';');
    text += ',';
    append_ids(text, event.after, ';');
    if (units.seconds) column(event.frame * *units.seconds);
    if (units.um) column(event.position.x * *units.um), column(event.position.y * *units.um);
    text += '\n';
  }
  write_text(out, text);
}

namespace {

/// Reads the whole stream, up to kLongestFile.
std::string read_text(std::istream& in) {
  std::string text;
  std::string block(std::size_t{1} << 16, '\0');
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block, 0, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLongestFile) throw core::IoError("longer than 256 MiB");
  }
  return text;
}

double read_number(const json& object, const char* key, double low, double high) {
  const auto found = object.find(key);
  if (found == object.end()) throw core::IoError("\"" + std::string(key) + "\" is missing");
  const bool good = found->is_number() && found->get<double>() >= low && found->get<double>() <= high;
  if (good) return found->get<double>();
  std::string text = "\"" + std::string(key) + "\" must be a number from ";
  core::append_number(text, low);
  text += " to ";
  core::append_number(text, high);
  throw core::IoError(text);
}

std::vector<SubgraphId> read_ids(const json& object, const char* key) {
  std::vector<SubgraphId> result;
  const auto found = object.find(key);
  if (found == object.end()) return result;
  const auto good = [](const json& id) {
    return id.is_number_unsigned() && id.get<std::uint64_t>() <= 0xffffffffU;
  };
  if (!found->is_array()) throw core::IoError("\"" + std::string(key) + "\" must be a list");
  for (const json& id : *found) {
    if (!good(id)) {
      throw core::IoError("\"" + std::string(key) + "\" must hold whole numbers from 0 to 4294967295");
    }
    result.push_back({id.get<std::uint32_t>()});
  }
  return result;
}

Event read_event(const json& object) {
  if (!object.is_object()) throw core::IoError("must be an object");
  Event event;
  const auto frame = object.find("frame");
  if (frame != object.end() && !frame->is_number_integer()) {
    throw core::IoError("\"frame\" must be a whole number");
  }
  event.frame = static_cast<int>(read_number(object, "frame", 0, 2147483647));
  const auto type = object.find("type");
  if (type == object.end()) throw core::IoError("\"type\" is missing");
  if (!type->is_string()) throw core::IoError("\"type\" must be a text");
  const auto known = event_type(type->get_ref<const std::string&>());
  if (!known) {
    throw core::IoError("the type " + core::quoted(type->get_ref<const std::string&>()) +
                        " is none of birth, death, split, merge, connect, disconnect");
  }
  event.type = *known;
  event.position = {read_number(object, "x", -1e6, 1e6), read_number(object, "y", -1e6, 1e6)};
  if (object.contains("probability")) event.probability = read_number(object, "probability", 0, 1);
  event.before = read_ids(object, "before");
  event.after = read_ids(object, "after");
  return event;
}

/// Checks format and version of events.json; a truth.json has neither.
void check_format(const json& object) {
  const auto format = object.find("format");
  if (format == object.end()) return;
  if (!format->is_string() || format->get_ref<const std::string&>() != "emberfold.events") {
    throw core::IoError(
        "its format is " +
        (format->is_string() ? core::quoted(format->get_ref<const std::string&>()) : "no text") +
        ", expected \"emberfold.events\"");
  }
  const auto version = object.find("version");
  if (version == object.end() || !version->is_number_unsigned() || *version < 1U) {
    throw core::IoError("\"version\" must be a whole number from 1");
  }
  if (*version > 1U) {
    throw core::IoError("format version " + version->dump() + " is newer than this program's, 1");
  }
}

std::vector<Event> parse_events(std::istream& in) {
  const std::string text = read_text(in);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) throw core::IoError("is empty");
  const json object = core::parse_json(text);
  if (!object.is_object()) throw core::IoError("holds no JSON object");
  check_format(object);
  const auto list = object.find("events");
  if (list == object.end() || !list->is_array()) throw core::IoError("has no list \"events\"");
  std::vector<Event> events;
  for (const json& item : *list) {
    try {
      events.push_back(read_event(item));
    } catch (const core::IoError& error) {
      throw core::IoError("event " + std::to_string(events.size()) + ": " + error.what());
    }
  }
  return events;
}

}  // namespace

std::vector<Event> read_events(std::istream& in, std::string_view name) {
  try {
    return parse_events(in);
  } catch (const core::IoError& error) {
    throw core::IoError(std::string(name) + ": " + error.what());
  }
}

}  // namespace emberfold::graph
