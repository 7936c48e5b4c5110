// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string_view>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "graph/exporting/tracking_files.hpp"

namespace emberfold::graph {

using Json = nlohmann::ordered_json;

namespace {

static_assert(std::endian::native == std::endian::little, "zarr arrays are written as they lie in memory");

constexpr const char* kGroup = R"({"zarr_format": 2})";

template <class Value>
constexpr const char* kType = std::is_floating_point_v<Value> ? "<f8"
                              : std::is_signed_v<Value>       ? "<i8"
                                                              : "<u8";
template <class Value>
constexpr const char* kName = std::is_floating_point_v<Value> ? "float64"
                              : std::is_signed_v<Value>       ? "int64"
                                                              : "uint64";

class Zarr {
 public:
  Zarr(std::string root, const WriteFile& write) : root_(std::move(root)), write_(write) {}

  void file(const std::string& path, std::string_view text) const {
    write_(root_ + "/" + path, [&](std::ostream& out) { out << text; });
  }
  void group(const std::string& path) const { file(path.empty() ? ".zgroup" : path + "/.zgroup", kGroup); }

  /// One chunk, not compressed. `row`: values in a row; 1 makes a list.
  template <class Value>
  void array(const std::string& path, const std::vector<Value>& values, std::size_t row = 1) const {
    Json shape = {values.size() / row};
    if (row > 1) shape.push_back(row);
    Json chunks = shape;
    chunks[0] = std::max<std::size_t>(1, values.size() / row);
    const Json about = {{"zarr_format", 2},      {"shape", shape},        {"chunks", chunks},
                        {"dtype", kType<Value>}, {"compressor", nullptr}, {"fill_value", 0},
                        {"order", "C"},          {"filters", nullptr}};
    file(path + "/.zarray", about.dump());
    if (values.empty()) return;
    file(path + (row > 1 ? "/0.0" : "/0"),
         {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)});
  }

  /// A property of nodes or edges; returns what the metadata say of it.
  template <class Value>
  Json property(const std::string& of, const std::string& name, const std::vector<Value>& values) const {
    group(of + "/props/" + name);
    array(of + "/props/" + name + "/values", values);
    return {{"identifier", name}, {"dtype", kName<Value>}, {"varlength", false}};
  }

 private:
  std::string root_;
  const WriteFile& write_;
};

/// Describes an axis: `unit` of its values.
template <class Value>
Json axis(const char* name, const char* kind, const char* unit, const std::vector<Value>& values) {
  Json made = {{"name", name}, {"type", kind}, {"unit", unit}};
  if (values.empty()) return made;
  const auto [low, high] = std::ranges::minmax(values);
  made["min"] = low, made["max"] = high;
  return made;
}

/// Describes the axis of time. Readers take its values as numbers of frames; `scale` makes seconds of them.
Json time_axis(const std::vector<std::int64_t>& frames, const Units& units) {
  Json made = axis("t", "time", "frame", frames);
  if (units.seconds) made["scale"] = *units.seconds, made["scaled_unit"] = "second";
  if (units.seconds && units.origin.seconds != 0) made["offset"] = units.origin.seconds;
  return made;
}

}  // namespace

void write_geff(const StrokeTree& tree, const TrackedClip& clip, const std::string& folder,
                const WriteFile& write) {
  const double um = clip.units.um.value_or(1);
  std::vector<double> y, x, length, time, probability;
  std::vector<std::int64_t> frame, stroke;
  std::vector<std::uint64_t> ids, pairs;
  for (const auto& row : tree.rows) {
    ids.push_back(ids.size());
    const Point place = clip.units.place(row.middle);
    y.push_back(place.y * um), x.push_back(place.x * um);
    time.push_back(clip.units.time(static_cast<int>(row.frame)));
    frame.push_back(row.frame), stroke.push_back(row.stroke), length.push_back(row.length * um);
  }
  for (const auto& link : tree.links) {
    pairs.insert(pairs.end(), {link.from, link.to});
    probability.push_back(link.probability);
  }
  const Zarr zarr(folder, write);
  zarr.group("");
  for (const char* part : {"nodes", "edges"}) zarr.group(part), zarr.group(std::string(part) + "/props");
  zarr.array("nodes/ids", ids);
  zarr.array("edges/ids", pairs, 2);
  const char* const place = clip.units.um ? "micrometer" : "pixel";
  Json about = {
      {"geff_version", "1.1.0"},
      {"directed", true},
      {"axes", {time_axis(frame, clip.units), axis("y", "space", place, y), axis("x", "space", place, x)}},
      {"display_hints", {{"display_horizontal", "x"}, {"display_vertical", "y"}, {"display_time", "t"}}}};
  about["node_props_metadata"] = {{"t", zarr.property("nodes", "t", frame)},
                                  {"y", zarr.property("nodes", "y", y)},
                                  {"x", zarr.property("nodes", "x", x)},
                                  {"frame", zarr.property("nodes", "frame", frame)},
                                  {tree.of, zarr.property("nodes", tree.of, stroke)},
                                  {"length", zarr.property("nodes", "length", length)}};
  if (!clip.units.times.empty())
    about["node_props_metadata"]["time_s"] = zarr.property("nodes", "time_s", time);
  about["edge_props_metadata"] = {{"probability", zarr.property("edges", "probability", probability)}};
  zarr.file(".zattrs", Json{{"geff", about}}.dump(1));
}

}  // namespace emberfold::graph
