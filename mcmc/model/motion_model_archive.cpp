// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/text/format_number.hpp"
#include "core/text/json_reader.hpp"
#include "graph/io/patch_range.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

namespace {

using core::NpyArray;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "emberfold.motion_model";
constexpr int kVersion = 1;
constexpr std::size_t kPatchColumns = 16;  // x y theta width blur contrast, left middle right of 3, type
constexpr std::size_t kMostPatches = std::size_t{1} << 26;
constexpr std::size_t kMostVelocityModes = 64;

// Numbers of patch types in the table: their places in graph::PatchType, but that 4 is left out, which was a
// type of older versions.
constexpr int kTypeLeftOut = 4;

// --- writing

double type_number(graph::PatchType type) {
  const int place = static_cast<int>(type);
  return place < kTypeLeftOut ? place : place + 1;
}

NpyArray table(std::vector<double> values, std::size_t columns) {
  return {{values.size() / columns, columns}, false, std::move(values)};
}

NpyArray map_array(const CellMap& map) {
  return {{static_cast<std::size_t>(map.rows), static_cast<std::size_t>(map.columns)}, false, map.values};
}

void append_patches(std::vector<double>& rows, const graph::AttributeGraph& graph) {
  for (const auto& vertex : graph.vertices()) {
    const auto& p = vertex.patch;
    rows.insert(rows.end(), {p.position.x, p.position.y, p.theta, p.width, p.blur, p.contrast});
    for (const auto& level : {p.left, p.middle, p.right})
      for (const float value : level) rows.push_back(static_cast<double>(value));
    rows.push_back(type_number(p.type));
  }
}

void append_edges(std::vector<std::int64_t>& rows, const graph::AttributeGraph& graph) {
  for (const auto& edge : graph.edges()) {
    rows.push_back(static_cast<std::int64_t>(graph.index_of(edge.a)));
    rows.push_back(static_cast<std::int64_t>(graph.index_of(edge.b)));
  }
}

NpyArray pairs(std::vector<std::int64_t> values) {
  return {{values.size() / 2, 2}, false, std::move(values)};
}

Json motion_json(const Autoregression& m) {
  return {{"a1", m.a1},       {"a2", m.a2},       {"coupling", m.coupling},
          {"noise", m.noise}, {"range", m.range}, {"measurement", m.measurement}};
}

// --- reading

[[noreturn]] void refuse(const std::string& why) {
  throw core::IoError("motion model: " + why);
}

double number(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number())
    refuse(std::string("\"") + key + "\" is no number in model.json");
  return found->get<double>();
}

int whole(const nlohmann::json& object, const char* key) {
  const double value = number(object, key);
  if (!(value >= 0 && value <= 1e9) || value != std::floor(value))
    refuse(std::string("\"") + key + "\" is " + core::number_text(value) + " in model.json, not a count");
  return static_cast<int>(value);
}

const nlohmann::json& part(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_object())
    refuse(std::string("\"") + key + "\" is missing in model.json");
  return *found;
}

template <std::size_t N>
std::array<double, N> numbers(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != N)
    refuse(std::string("\"") + key + "\" is no list of " + std::to_string(N) + " numbers in model.json");
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    if (!(*found)[i].is_number()) refuse(std::string("\"") + key + "\" holds something else than numbers");
    values[i] = (*found)[i].get<double>();
  }
  return values;
}

Autoregression read_motion(const nlohmann::json& object) {
  return {number(object, "a1"),    number(object, "a2"),    number(object, "coupling"),
          number(object, "noise"), number(object, "range"), number(object, "measurement")};
}

std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const auto size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

// The array of this name, of two dimensions, row by row; `rows`: any where not given.
template <class Value>
const std::vector<Value>& rows_of(const core::ModelArchive& archive, const std::string& name,
                                  std::size_t columns, std::optional<std::size_t> rows = {}) {
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) refuse(name + ".npy is missing");
  const auto& array = found->second;
  const bool fits =
      array.shape.size() == 2 && array.shape[1] == columns && (!rows || array.shape[0] == *rows);
  if (!fits || (array.fortran_order && array.shape[0] > 1 && columns > 1))
    refuse(name + ".npy is " + shape_text(array.shape) + (array.fortran_order ? " in Fortran order" : "") +
           "; expected " + (rows ? std::to_string(*rows) : "N") + " x " + std::to_string(columns));
  if (array.shape[0] > kMostPatches) refuse(name + ".npy has " + std::to_string(array.shape[0]) + " rows");
  const auto* const values = std::get_if<std::vector<Value>>(&array.data);
  if (!values)
    refuse(name + ".npy holds another type than " + (std::is_same_v<Value, double> ? "float64" : "int64"));
  return *values;
}

CellMap read_map(const core::ModelArchive& archive, const std::string& name, double cell, int width,
                 int height) {
  CellMap map;
  map.cell = cell;
  map.columns = static_cast<int>(std::ceil(width / cell));
  map.rows = static_cast<int>(std::ceil(height / cell));
  map.values = rows_of<double>(archive, name, static_cast<std::size_t>(map.columns),
                               static_cast<std::size_t>(map.rows));
  return map;
}

graph::PatchType type_of(double number, const std::string& name) {
  if (!(number >= 0 && number <= type_number(graph::PatchType::crossing)) || number != std::floor(number) ||
      number == kTypeLeftOut)
    refuse(name + ".npy holds a patch of no known type");
  const int place = static_cast<int>(number);
  return static_cast<graph::PatchType>(place < kTypeLeftOut ? place : place - 1);
}

graph::Patch read_patch(const double* row, const std::string& name) {
  for (std::size_t i = 0; i < kPatchColumns; ++i)
    if (!std::isfinite(row[i])) refuse(name + ".npy holds a number that is not finite");
  graph::Patch p;
  p.position = {row[0], row[1]};
  p.theta = row[2], p.width = row[3], p.blur = row[4], p.contrast = row[5];
  for (std::size_t c = 0; c < 3; ++c) {
    p.left[c] = static_cast<float>(row[6 + c]);
    p.middle[c] = static_cast<float>(row[9 + c]);
    p.right[c] = static_cast<float>(row[12 + c]);
  }
  p.type = type_of(row[15], name);
  if (const auto why = graph::detail::describe_range_error(p); !why.empty()) refuse(name + ".npy: " + why);
  return p;
}

// The next graph of the tables of this kind: "first" or "exemplar".
struct GraphTables {
  std::string patches_name, edges_name;
  const std::vector<double>& patches;
  const std::vector<std::int64_t>& edges;
  std::size_t next_patch = 0, next_edge = 0;

  GraphTables(const core::ModelArchive& archive, const std::string& kind)
      : patches_name(kind + "_patches"),
        edges_name(kind + "_edges"),
        patches(rows_of<double>(archive, patches_name, kPatchColumns)),
        edges(rows_of<std::int64_t>(archive, edges_name, 2)) {}

  graph::AttributeGraph take(std::size_t patch_count, std::size_t edge_count) {
    if (patch_count > patches.size() / kPatchColumns - next_patch ||
        edge_count > edges.size() / 2 - next_edge)
      refuse(patches_name + ".npy and " + edges_name + ".npy hold fewer rows than the exemplars need");
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> joined;
    for (std::size_t i = 0; i < patch_count; ++i)
      vertices.push_back({{static_cast<std::uint32_t>(i)},
                          {},
                          read_patch(&patches[(next_patch + i) * kPatchColumns], patches_name)});
    const auto end = [&](std::size_t at) {
      const std::int64_t index = edges[at];
      if (index < 0 || static_cast<std::size_t>(index) >= patch_count)
        refuse(edges_name + ".npy names patch " + std::to_string(index) + " of " +
               std::to_string(patch_count));
      return graph::VertexId{static_cast<std::uint32_t>(index)};
    };
    for (std::size_t i = 0; i < edge_count; ++i)
      joined.push_back({end((next_edge + i) * 2), end((next_edge + i) * 2 + 1)});
    next_patch += patch_count, next_edge += edge_count;
    try {
      return {std::move(vertices), std::move(joined)};
    } catch (const core::InputError& error) {
      refuse(edges_name + ".npy: " + error.what());
    }
  }
  void finish() const {
    if (next_patch * kPatchColumns != patches.size() || next_edge * 2 != edges.size())
      refuse(patches_name + ".npy and " + edges_name + ".npy hold more rows than the exemplars need");
  }
};

void read_exemplars(const core::ModelArchive& archive, MotionModel& model) {
  GraphTables tables(archive, "exemplar");
  const auto& sizes = rows_of<std::int64_t>(archive, "exemplar_sizes", 2);
  const auto& places = rows_of<double>(archive, "exemplar_places", 3, sizes.size() / 2);
  for (std::size_t i = 0; i < sizes.size() / 2; ++i) {
    if (sizes[2 * i] < 1 || sizes[2 * i + 1] < 0) refuse("exemplar_sizes.npy holds a size that is none");
    model.exemplars.push_back(
        {tables.take(static_cast<std::size_t>(sizes[2 * i]), static_cast<std::size_t>(sizes[2 * i + 1])),
         {places[3 * i], places[3 * i + 1]},
         places[3 * i + 2]});
  }
  tables.finish();
  GraphTables first(archive, "first");
  model.first = first.take(first.patches.size() / kPatchColumns, first.edges.size() / 2);
}

nlohmann::json header(const core::ModelArchive& archive) {
  nlohmann::json json;
  try {
    json = core::parse_json(archive.text);
  } catch (const core::IoError& error) {
    refuse(std::string("model.json: ") + error.what());
  }
  if (!json.is_object() || !json.contains("format") || json["format"] != kFormat)
    refuse(std::string("model.json does not say \"format\": \"") + kFormat + "\"");
  if (const int version = whole(json, "version"); version != kVersion)
    refuse("version " + std::to_string(version) + "; this program reads version " + std::to_string(kVersion));
  return json;
}

RateModifiers read_modifiers(const Json& json) {
  return {numbers<kElapsedClasses>(json, "death"),   numbers<kElapsedClasses>(json, "parting"),
          numbers<kElapsedClasses>(json, "uniting"), numbers<kGapClasses>(json, "bridging"),
          numbers<kTurnClasses>(json, "turning"),    number(json, "pace")};
}

HardCoreDistances read_hard_core(const Json& json) {
  return {number(json, "alike"), number(json, "lines"), number(json, "mixed")};
}

// Older models have none.
VelocityModes read_velocity_modes(const core::ModelArchive& archive, std::size_t cells) {
  const auto found = archive.arrays.find("velocity_modes");
  if (found == archive.arrays.end()) {
    for (const char* name : {"velocity_step", "velocity_noise"})
      if (archive.arrays.contains(name)) refuse("velocity_modes.npy is missing");
    return {};
  }
  const auto& shape = found->second.shape;
  if (shape.size() != 2 || shape[1] < 1 || shape[1] > kMostVelocityModes)
    refuse("velocity_modes.npy is " + shape_text(shape) + "; expected N x 1 to " +
           std::to_string(kMostVelocityModes));
  const std::size_t n = shape[1];
  return {n, rows_of<double>(archive, "velocity_modes", n, 2 * cells),
          rows_of<double>(archive, "velocity_step", n, n), rows_of<double>(archive, "velocity_noise", n, n)};
}

}  // namespace

core::ModelArchive to_archive(const MotionModel& model) {
  validate(model);
  const auto& rates = model.rates;
  const Json json = {{"format", kFormat},
                     {"version", kVersion},
                     {"width", model.width},
                     {"height", model.height},
                     {"fps", model.fps},
                     {"frames", model.frames},
                     {"sway", motion_json(model.displacement)},
                     {"contrast", motion_json(model.contrast)},
                     {"cell", model.density.cell},
                     {"rates",
                      {{"birth_by_size", rates.birth_by_size},
                       {"death_by_size", rates.death_by_size},
                       {"split", rates.split},
                       {"merge", rates.merge},
                       {"connect", rates.connect},
                       {"disconnect", rates.disconnect},
                       {"reach", rates.reach},
                       {"split_gap", rates.split_gap},
                       {"disconnect_gap", rates.disconnect_gap},
                       {"hold", rates.refractory_period},
                       {"circumstances",
                        {{"death", rates.modifiers.death},
                         {"parting", rates.modifiers.separation},
                         {"uniting", rates.modifiers.unification},
                         {"bridging", rates.modifiers.bridging},
                         {"turning", rates.modifiers.turning},
                         {"pace", rates.modifiers.pace}}}}},
                     {"exclusion",
                      {{"alike", model.hard_core.alike},
                       {"lines", model.hard_core.lines},
                       {"mixed", model.hard_core.mixed}}},
                     {"appearing", model.appearing},
                     {"vanishing", model.vanishing}};
  core::ModelArchive archive;
  archive.text = json.dump(1) + "\n";
  archive.arrays = {{"birth", map_array(rates.birth)},
                    {"death", map_array(rates.death)},
                    {"density", map_array(model.density)},
                    {"parting", map_array(rates.separation)},
                    {"sway_share", map_array(model.displacement_scale)},
                    {"drift_x", map_array(model.drift_x)},
                    {"drift_y", map_array(model.drift_y)}};
  if (const std::size_t n = model.velocity.count; n > 0) {
    archive.arrays["velocity_modes"] = table(model.velocity.modes, n);
    archive.arrays["velocity_step"] = table(model.velocity.step, n);
    archive.arrays["velocity_noise"] = table(model.velocity.noise, n);
  }
  std::vector<double> patches, places, first;
  std::vector<std::int64_t> edges, sizes, first_edges;
  for (const auto& exemplar : model.exemplars) {
    append_patches(patches, exemplar.graph);
    append_edges(edges, exemplar.graph);
    sizes.push_back(static_cast<std::int64_t>(exemplar.graph.size()));
    sizes.push_back(static_cast<std::int64_t>(exemplar.graph.edges().size()));
    places.insert(places.end(), {exemplar.place.x, exemplar.place.y, exemplar.clearance});
  }
  append_patches(first, model.first);
  append_edges(first_edges, model.first);
  archive.arrays["exemplar_patches"] = table(std::move(patches), kPatchColumns);
  archive.arrays["exemplar_edges"] = pairs(std::move(edges));
  archive.arrays["exemplar_sizes"] = pairs(std::move(sizes));
  archive.arrays["exemplar_places"] = table(std::move(places), 3);
  archive.arrays["first_patches"] = table(std::move(first), kPatchColumns);
  archive.arrays["first_edges"] = pairs(std::move(first_edges));
  return archive;
}

MotionModel motion_model(const core::ModelArchive& archive) {
  const auto json = header(archive);
  MotionModel model;
  model.width = whole(json, "width"), model.height = whole(json, "height");
  if (model.width < 1 || model.width > 65536 || model.height < 1 || model.height > 65536)
    refuse("the frame is " + std::to_string(model.width) + " x " + std::to_string(model.height) +
           " px; allowed is 1 to 65536 each way");
  model.fps = number(json, "fps");
  model.frames = whole(json, "frames");
  model.displacement = read_motion(part(json, "sway"));
  model.contrast = read_motion(part(json, "contrast"));
  const auto& rates = part(json, "rates");
  model.rates.birth_by_size = numbers<kSizeClasses>(rates, "birth_by_size");
  model.rates.death_by_size = numbers<kSizeClasses>(rates, "death_by_size");
  model.rates.split = number(rates, "split"), model.rates.merge = number(rates, "merge");
  model.rates.connect = number(rates, "connect"), model.rates.disconnect = number(rates, "disconnect");
  model.rates.reach = number(rates, "reach");
  model.rates.split_gap = number(rates, "split_gap");
  model.rates.disconnect_gap = number(rates, "disconnect_gap");
  // Older models lack these.
  if (rates.contains("hold")) model.rates.refractory_period = number(rates, "hold");
  if (rates.contains("circumstances")) model.rates.modifiers = read_modifiers(part(rates, "circumstances"));
  if (json.contains("exclusion")) model.hard_core = read_hard_core(part(json, "exclusion"));
  model.appearing = numbers<8>(json, "appearing");
  model.vanishing = numbers<8>(json, "vanishing");
  const double cell = number(json, "cell");
  if (!(cell >= 1 && cell <= 65536))
    refuse("\"cell\" is " + core::number_text(cell) + "; allowed is 1 to 65536 px");
  const auto map = [&](const char* name) { return read_map(archive, name, cell, model.width, model.height); };
  model.rates.birth = map("birth"), model.rates.death = map("death");
  model.rates.separation = map("parting"), model.displacement_scale = map("sway_share");
  model.density = map("density");
  model.drift_x = map("drift_x"), model.drift_y = map("drift_y");
  model.velocity = read_velocity_modes(archive, model.density.values.size());
  read_exemplars(archive, model);
  try {
    validate(model);
  } catch (const core::InputError& error) {
    throw core::IoError(error.what());
  }
  return model;
}

}  // namespace emberfold::mcmc
