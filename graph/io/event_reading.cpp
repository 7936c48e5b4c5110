// SPDX-License-Identifier: Apache-2.0
#include "graph/io/event_reading.hpp"

#include <algorithm>
#include <istream>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::graph::detail {

namespace {

using nlohmann::json;

constexpr std::size_t kLongestFile = std::size_t{1} << 28;  // bytes, 256 MiB: bounds the memory of reading

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

/// Returns the format of the file, that of its kind where it names none, as a truth.json.
std::string check_format(const json& object, const std::vector<std::string>& formats) {
  const auto format = object.find("format");
  if (format == object.end()) return formats.front();
  const auto known = std::ranges::find_if(formats, [&](const std::string& one) { return *format == one; });
  if (known == formats.end()) {
    const bool is_text = format->is_string();
    throw core::IoError("its format is " +
                        (is_text ? core::quoted(format->get_ref<const std::string&>()) : "no text") +
                        ", expected \"" + formats.front() + "\"");
  }
  const auto version = object.find("version");
  if (version == object.end() || !version->is_number_unsigned() || *version < 1U) {
    throw core::IoError("\"version\" must be a whole number from 1");
  }
  if (*version > 1U) {
    throw core::IoError("format version " + version->dump() + " is newer than this program's, 1");
  }
  return *known;
}

}  // namespace

std::string read_event_list(std::istream& in, const std::vector<std::string>& formats,
                            const std::function<void(const json&, Event)>& take) {
  const std::string text = read_text(in);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) throw core::IoError("is empty");
  const json object = core::parse_json(text);
  if (!object.is_object()) throw core::IoError("holds no JSON object");
  const std::string format = check_format(object, formats);
  const auto list = object.find("events");
  if (list == object.end() || !list->is_array()) throw core::IoError("has no list \"events\"");
  std::size_t count = 0;
  for (const json& item : *list) {
    try {
      take(item, read_event(item));
    } catch (const core::IoError& error) {
      throw core::IoError("event " + std::to_string(count) + ": " + error.what());
    }
    ++count;
  }
  return format;
}

}  // namespace emberfold::graph::detail
