// SPDX-License-Identifier: Apache-2.0
#include "dytex/model/archive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/core/hal/interface.h>

#include "core/error.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::string_view kFormat = "emberfold.linear_dynamic_texture";
constexpr int kVersion = 2;
// Bounds on sizes in a file, far above every real model: they keep sizes within 64 bits.
constexpr int kMostNesting = 16;  // levels of brackets in model.json
constexpr std::int64_t kMostVersion = std::int64_t{1} << 31;
constexpr std::int64_t kMostStoredSide = 65536;  // px
constexpr std::int64_t kMostFrames = 1 << 24, kMostComponents = 1 << 24;
constexpr std::array<std::pair<int, const char*>, 3> kDepths{
    {{CV_8U, "u8"}, {CV_16U, "u16"}, {CV_32F, "f32"}}};

template <class Matrix>
core::NpyView array_of(const Matrix& matrix) {
  using Scalar = typename Matrix::Scalar;
  core::NpyView array{{static_cast<std::size_t>(matrix.rows())}, false, {}};
  if constexpr (Matrix::ColsAtCompileTime != 1) {
    array.shape.push_back(static_cast<std::size_t>(matrix.cols()));
    array.fortran_order = true;
  }
  array.data = std::span<const Scalar>(matrix.data(), static_cast<std::size_t>(matrix.size()));
  return array;
}

[[noreturn]] void refuse_archive(const std::string& what) {
  throw core::IoError("model: " + what);
}

nlohmann::json parse(const std::string& text) {
  const auto shallow = [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    if (depth > kMostNesting)
      refuse_archive("model.json is nested more than " + std::to_string(kMostNesting) + " deep");
    return true;
  };
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(text, shallow);
  } catch (const nlohmann::json::exception&) {
    refuse_archive("model.json is no valid JSON");
  }
  if (!json.is_object()) refuse_archive("model.json holds no object");
  return json;
}

const nlohmann::json& entry(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) refuse_archive("model.json has no \"" + std::string(key) + "\"");
  return *found;
}

std::string text_entry(const nlohmann::json& json, const char* key) {
  const nlohmann::json& value = entry(json, key);
  if (!value.is_string()) refuse_archive("\"" + std::string(key) + "\" must be a text");
  return value.get<std::string>();
}

std::int64_t whole_number(const nlohmann::json& json, const char* key, std::int64_t least,
                          std::int64_t most) {
  const nlohmann::json& value = entry(json, key);
  const bool fits = value.is_number_integer() &&
                    (!value.is_number_unsigned() || value.get<std::uint64_t>() <= std::uint64_t{1} << 62);
  if (!fits || value.get<std::int64_t>() < least || value.get<std::int64_t>() > most)
    refuse_archive("\"" + std::string(key) + "\" is " + core::quoted(value.dump()) +
                   ", must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return value.get<std::int64_t>();
}

double number(const nlohmann::json& json, const char* key) {
  const nlohmann::json& value = entry(json, key);
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    refuse_archive("\"" + std::string(key) + "\" is " + core::quoted(value.dump()) +
                   ", must be a finite number");
  return value.get<double>();
}

/// Returns the version, one of those that can be read.
std::int64_t check_format(const nlohmann::json& json) {
  if (const std::string format = text_entry(json, "format"); format != kFormat)
    refuse_archive("\"format\" is " + core::quoted(format) + ", must be \"" + std::string(kFormat) + "\"");
  const std::int64_t version = whole_number(json, "version", 1, kMostVersion);
  if (version > kVersion)
    refuse_archive("version " + std::to_string(version) + " is newer than " + std::to_string(kVersion) +
                   ", the newest that can be read");
  return version;
}

core::ClipInfo read_info(const nlohmann::json& json) {
  core::ClipInfo info;
  info.width = static_cast<int>(whole_number(json, "width", 1, kMostStoredSide));
  info.height = static_cast<int>(whole_number(json, "height", 1, kMostStoredSide));
  info.channels = static_cast<int>(whole_number(json, "channels", 1, 3));
  info.frames = whole_number(json, "frames", 1, kMostFrames);
  info.fps = number(json, "fps");
  info.white = number(json, "white");
  const std::string depth = text_entry(json, "depth");
  const auto* const known =
      std::find_if(kDepths.begin(), kDepths.end(), [&](const auto& d) { return d.second == depth; });
  if (known == kDepths.end())
    refuse_archive("\"depth\" is " + core::quoted(depth) + R"(, must be "u8", "u16" or "f32")");
  info.depth = known->first;
  return info;
}

std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

template <class Scalar>
using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

const core::NpyArray& array_named(const core::ModelArchive& archive, const char* name) {
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) refuse_archive("the array " + std::string(name) + " is missing");
  return found->second;
}

/// Returns the numbers of an array whose shape must match `shape`, of one or two extents.
template <class Stored>
const std::vector<Stored>& numbers(const core::NpyArray& array, const char* name, const char* types,
                                   const std::vector<std::size_t>& shape) {
  const auto* data = std::get_if<std::vector<Stored>>(&array.data);
  if (data == nullptr) refuse_archive("the array " + std::string(name) + " must hold " + types);
  if (array.shape != shape)
    refuse_archive("the array " + std::string(name) + " has the shape " + shape_text(array.shape) +
                   ", must have " + shape_text(shape));
  if (data->size() != shape[0] * (shape.size() > 1 ? shape[1] : 1))
    refuse_archive("the array " + std::string(name) + " has " + std::to_string(data->size()) +
                   " numbers, its shape " + shape_text(shape) + " another number");
  return *data;
}

/// Returns numbers stored in their array's order, in columns.
template <class Scalar>
Columns<Scalar> arranged(const std::vector<Scalar>& data, const core::NpyArray& array) {
  const auto rows = static_cast<Eigen::Index>(array.shape[0]);
  const auto columns = static_cast<Eigen::Index>(array.shape.size() > 1 ? array.shape[1] : 1);
  using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (array.fortran_order || array.shape.size() == 1)
    return Eigen::Map<const Columns<Scalar>>(data.data(), rows, columns);
  return Eigen::Map<const Rows>(data.data(), rows, columns);
}

template <class Scalar>
Columns<Scalar> read_matrix(const core::ModelArchive& archive, const char* name,
                            const std::vector<std::size_t>& shape) {
  const core::NpyArray& array = array_named(archive, name);
  return arranged(numbers<Scalar>(array, name, std::is_same_v<Scalar, float> ? "float32" : "float64", shape),
                  array);
}

/// Reads the mean, or C: float32, float16, or uint8 with its columns' scales and offsets.
Columns<float> read_levels(const core::ModelArchive& archive, const std::string& name,
                           const std::vector<std::size_t>& shape) {
  constexpr const char* kTypes = "float32, float16 or uint8";
  const core::NpyArray& array = array_named(archive, name.c_str());
  if (std::holds_alternative<std::vector<core::Half>>(array.data)) {
    const auto& halves = numbers<core::Half>(array, name.c_str(), kTypes, shape);
    std::vector<float> wide(halves.size());
    std::ranges::transform(halves, wide.begin(), core::to_float);
    return arranged(wide, array);
  }
  if (std::holds_alternative<std::vector<std::uint8_t>>(array.data)) {
    const Columns<std::uint8_t> steps =
        arranged(numbers<std::uint8_t>(array, name.c_str(), kTypes, shape), array);
    const std::vector<std::size_t> each{shape.size() > 1 ? shape[1] : 1};
    const Eigen::VectorXf scale = read_matrix<float>(archive, (name + "_scale").c_str(), each);
    const Eigen::VectorXf offset = read_matrix<float>(archive, (name + "_offset").c_str(), each);
    Columns<float> levels = steps.cast<float>() * scale.asDiagonal();
    levels.rowwise() += offset.transpose();
    return levels;
  }
  return arranged(numbers<float>(array, name.c_str(), kTypes, shape), array);
}

struct Extents {
  std::size_t values, components;
};

/// Reads the entries that version 1 did not have.
void read_second_version(const nlohmann::json& json, const core::ModelArchive& archive,
                         const Extents& extents, LinearDynamicTexture& texture) {
  texture.weights = read_matrix<double>(archive, "weights", {extents.components});
  const nlohmann::json& each = entry(json, "noise_per_value");
  if (!each.is_boolean()) refuse_archive("\"noise_per_value\" must be true or false");
  if (each.get<bool>()) texture.noise = read_matrix<float>(archive, "noise", {extents.values});
  if (json.contains("noise_share")) texture.noise_share = number(json, "noise_share");
}

}  // namespace

core::ModelView archive_view(const LinearDynamicTexture& texture) {
  validate(texture);
  const core::ClipInfo& info = texture.info;
  const auto* const depth =
      std::find_if(kDepths.begin(), kDepths.end(), [&](const auto& d) { return d.first == info.depth; });
  nlohmann::ordered_json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["width"] = info.width;
  json["height"] = info.height;
  json["channels"] = info.channels;
  json["fps"] = info.fps;
  json["frames"] = *info.frames;
  json["depth"] = depth->second;
  json["white"] = info.white;
  json["components"] = texture.components();
  json["order"] = texture.order();
  json["noise_inputs"] = texture.B.cols();
  json["r"] = texture.r;
  json["noise_per_value"] = texture.noise.size() > 0;
  if (texture.noise_share < 1) json["noise_share"] = texture.noise_share;
  core::ModelView archive{json.dump(2) + "\n", {}};
  archive.arrays["C"] = array_of(texture.C);
  archive.arrays["mean"] = array_of(texture.mean);
  archive.arrays["weights"] = array_of(texture.weights);
  archive.arrays["A"] = array_of(texture.A);
  archive.arrays["B"] = array_of(texture.B);
  archive.arrays["states"] = array_of(texture.states);
  archive.arrays["singular"] = array_of(texture.singular);
  if (texture.noise.size() > 0) archive.arrays["noise"] = array_of(texture.noise);
  return archive;
}

core::ModelArchive to_archive(const LinearDynamicTexture& texture) {
  core::ModelView view = archive_view(texture);
  core::ModelArchive archive{std::move(view.text), {}};
  for (const auto& [name, array] : view.arrays) {
    const auto copied = [](const auto& values) -> core::NpyArray::Data {
      return std::vector(values.begin(), values.end());
    };
    archive.arrays[name] = {array.shape, array.fortran_order, std::visit(copied, array.data)};
  }
  return archive;
}

LinearDynamicTexture linear_dynamic_texture(const core::ModelArchive& archive) {
  const nlohmann::json json = parse(archive.text);
  const bool first_version = check_format(json) == 1;
  LinearDynamicTexture texture;
  texture.info = read_info(json);
  texture.r = number(json, "r");
  const auto n = static_cast<std::size_t>(whole_number(json, "components", 0, kMostComponents));
  const auto order =
      first_version ? n : static_cast<std::size_t>(whole_number(json, "order", 0, kMostComponents));
  const auto k =
      static_cast<std::size_t>(whole_number(json, "noise_inputs", 0, static_cast<std::int64_t>(order)));
  const auto m = static_cast<std::size_t>(texture.info.width) *
                 static_cast<std::size_t>(texture.info.height) *
                 static_cast<std::size_t>(texture.info.channels);
  const auto frames = static_cast<std::size_t>(*texture.info.frames);
  texture.mean = read_levels(archive, "mean", {m});
  texture.C = read_levels(archive, "C", {m, n});
  texture.A = read_matrix<double>(archive, "A", {order, order});
  texture.B = read_matrix<double>(archive, "B", {order, k});
  texture.states = read_matrix<double>(archive, "states", {order, frames});
  texture.weights = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(n));
  if (!first_version) read_second_version(json, archive, {m, n}, texture);
  texture.singular = read_matrix<double>(archive, "singular", {frames});
  try {
    validate(texture);
  } catch (const core::InputError& error) {
    refuse_archive(error.what());
  } catch (const core::NumericalError& error) {
    refuse_archive(error.what());
  }
  return texture;
}

}  // namespace emberfold::dytex
