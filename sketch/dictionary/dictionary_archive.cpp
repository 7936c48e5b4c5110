// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"
#include "sketch/dictionary/dictionary.hpp"

namespace emberfold::sketch {

namespace {

using core::NpyArray;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "emberfold.dictionary";
constexpr int kVersion = 1;
constexpr std::size_t kMostGroups = 64;
constexpr std::size_t kWindowSamples = kWindowSide * kWindowSide;

[[noreturn]] void refuse(const std::string& why) {
  throw core::IoError("dictionary: " + why);
}

/// Rows of one length, as an array.
NpyArray table(std::vector<float> values, std::size_t columns) {
  return {{values.size() / columns, columns}, false, std::move(values)};
}
template <class Value>
NpyArray list(std::vector<Value> values) {
  return {{values.size()}, false, std::move(values)};
}

std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const auto size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text.empty() ? "one number" : text;
}

/// The numbers of an array of this shape, row by row.
template <class Value>
std::vector<Value> values_of(const core::ModelArchive& archive, const std::string& name,
                             const std::vector<std::size_t>& shape) {
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) refuse(name + ".npy is missing");
  const NpyArray& array = found->second;
  const auto* const data = std::get_if<std::vector<Value>>(&array.data);
  if (!data)
    refuse(name + ".npy holds another type than " +
           (std::is_same_v<Value, float>    ? "float32"
            : std::is_same_v<Value, double> ? "float64"
                                            : "int64"));
  if (array.shape != shape)
    refuse(name + ".npy is " + shape_text(array.shape) + ", must be " + shape_text(shape));
  std::size_t count = 1;
  for (const auto size : shape) count *= size;
  if (data->size() != count) refuse(name + ".npy has not as many numbers as its shape tells");
  if (!array.fortran_order || shape.size() < 2) return *data;
  std::vector<Value> rows(count);
  for (std::size_t i = 0; i < shape[0]; ++i)
    for (std::size_t j = 0; j < shape[1]; ++j) rows[i * shape[1] + j] = (*data)[j * shape[0] + i];
  return rows;
}

const nlohmann::json& part(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) refuse(std::string("model.json has no \"") + key + "\"");
  return *found;
}

int whole(const nlohmann::json& object, const char* key, int least, int most) {
  const nlohmann::json& value = part(object, key);
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!(number >= least && number <= most) || number != std::floor(number))
    refuse(std::string("\"") + key + "\" is " + core::quoted(value.dump()) +
           ", must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(number);
}

std::string text(const nlohmann::json& object, const char* key) {
  const nlohmann::json& value = part(object, key);
  if (!value.is_string()) refuse(std::string("\"") + key + "\" must be a text");
  return value.get<std::string>();
}

void check_header(const nlohmann::json& json) {
  if (!json.is_object()) refuse("model.json holds no object");
  if (const std::string format = text(json, "format"); format != kFormat)
    refuse("the format is " + core::quoted(format) + ", must be \"" + kFormat + "\"");
  if (const int version = whole(json, "version", 1, 1 << 30); version > kVersion)
    refuse("version " + std::to_string(version) + " is newer than " + std::to_string(kVersion) +
           ", the newest that can be read");
  whole(json, "profile_samples", int{kProfileSamples}, int{kProfileSamples});
  whole(json, "window_side", int{kWindowSide}, int{kWindowSide});
}

/// Reads the entries from model.json; each gets room for as many components as it should have.
std::vector<DictionaryEntry> read_entries(const nlohmann::json& json) {
  const nlohmann::json& list = part(json, "entries");
  if (!list.is_array() || list.size() > kMostGroups * kMostEntries)
    refuse("\"entries\" must be a list of at most " + std::to_string(kMostGroups * kMostEntries));
  std::vector<DictionaryEntry> entries;
  for (const nlohmann::json& told : list) {
    if (!told.is_object()) refuse("\"entries\" holds something else than objects");
    DictionaryEntry entry;
    const std::string type = text(told, "type");
    const auto known = graph::patch_type(type);
    if (!known) refuse("\"type\" is " + core::quoted(type) + ", which is no type of a patch");
    entry.type = *known;
    entry.degree = whole(told, "degree", 0, 4);
    entry.components.resize(
        static_cast<std::size_t>(whole(told, "components", 0, static_cast<int>(kMostComponents))));
    entries.push_back(std::move(entry));
  }
  return entries;
}

/// Goes through the rows of two tables, profiles' and windows'.
struct Rows {
  std::vector<float> profiles, windows;
  std::size_t profile = 0, window = 0;

  std::vector<float> next(bool of_window) {
    const auto& from = of_window ? windows : profiles;
    std::size_t& row = of_window ? window : profile;
    const std::size_t size = of_window ? kWindowSamples : kProfileSamples;
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(size * row++);
    return {begin, begin + static_cast<std::ptrdiff_t>(size)};
  }
};

void set_shares(std::vector<DictionaryEntry>& entries) {
  for (DictionaryEntry& entry : entries) {
    double group = 0;
    for (const DictionaryEntry& other : entries)
      if (other.degree == entry.degree && other.type == entry.type) group += static_cast<double>(other.seen);
    entry.share = static_cast<double>(entry.seen) / group;
  }
}

}  // namespace

core::ModelArchive to_archive(const Dictionary& dictionary) {
  validate(dictionary);
  Json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["profile_samples"] = kProfileSamples;
  json["window_side"] = kWindowSide;
  json["entries"] = Json::array();
  std::array<std::vector<float>, 2> means, components;  // profiles', windows'
  std::vector<double> spreads, residuals;
  std::vector<std::int64_t> seen;
  for (const DictionaryEntry& entry : dictionary.entries) {
    json["entries"].push_back({{"degree", entry.degree},
                               {"type", graph::name(entry.type)},
                               {"share", entry.share},
                               {"components", entry.components.size()}});
    const std::size_t kind = entry.window() ? 1 : 0;
    means[kind].insert(means[kind].end(), entry.mean.begin(), entry.mean.end());
    for (const auto& component : entry.components)
      components[kind].insert(components[kind].end(), component.begin(), component.end());
    spreads.insert(spreads.end(), entry.spread.begin(), entry.spread.end());
    residuals.push_back(entry.residual);
    seen.push_back(static_cast<std::int64_t>(entry.seen));
  }
  core::ModelArchive archive{json.dump(2) + "\n", {}};
  archive.arrays["profiles"] = table(std::move(means[0]), kProfileSamples);
  archive.arrays["windows"] = table(std::move(means[1]), kWindowSamples);
  archive.arrays["profile_components"] = table(std::move(components[0]), kProfileSamples);
  archive.arrays["window_components"] = table(std::move(components[1]), kWindowSamples);
  archive.arrays["spreads"] = list(std::move(spreads));
  archive.arrays["residuals"] = list(std::move(residuals));
  archive.arrays["seen"] = list(std::move(seen));
  return archive;
}

Dictionary read_dictionary(const core::ModelArchive& archive) {
  nlohmann::json json;
  try {
    json = core::parse_json(archive.text);
  } catch (const core::IoError& error) {
    refuse(std::string("model.json: ") + error.what());
  }
  check_header(json);
  Dictionary result{read_entries(json)};
  std::array<std::size_t, 2> means{}, components{};
  for (const DictionaryEntry& entry : result.entries) {
    means[entry.window() ? 1 : 0] += 1;
    components[entry.window() ? 1 : 0] += entry.components.size();
  }
  Rows mean{values_of<float>(archive, "profiles", {means[0], kProfileSamples}),
            values_of<float>(archive, "windows", {means[1], kWindowSamples})};
  Rows component{values_of<float>(archive, "profile_components", {components[0], kProfileSamples}),
                 values_of<float>(archive, "window_components", {components[1], kWindowSamples})};
  const auto spreads = values_of<double>(archive, "spreads", {components[0] + components[1]});
  const auto residuals = values_of<double>(archive, "residuals", {result.entries.size()});
  const auto seen = values_of<std::int64_t>(archive, "seen", {result.entries.size()});
  std::size_t spread = 0;
  for (std::size_t i = 0; i < result.entries.size(); ++i) {
    DictionaryEntry& entry = result.entries[i];
    entry.mean = mean.next(entry.window());
    for (auto& values : entry.components) {
      values = component.next(entry.window());
      entry.spread.push_back(spreads[spread++]);
    }
    entry.residual = residuals[i];
    if (seen[i] < 1 || seen[i] > std::int64_t{1} << 52)
      refuse("seen.npy holds " + std::to_string(seen[i]) + ", must be 1 to 2^52");
    entry.seen = static_cast<std::uint64_t>(seen[i]);
  }
  set_shares(result.entries);
  try {
    validate(result);
  } catch (const core::InputError& error) {
    throw core::IoError(error.what());
  }
  return result;
}

}  // namespace emberfold::sketch
