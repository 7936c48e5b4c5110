// SPDX-License-Identifier: Apache-2.0
#include "core/io/model_folder.hpp"

#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/image_files.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kText = "model.json";
constexpr std::size_t kMostArrays = 256;
constexpr std::string_view kFamily = "emberfold.";

/// Returns whether a folder below a model's is a model, as motion models once held one.
bool is_part(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) && fs::is_regular_file(path / kText, ignored);
}

// Returns whether a file belongs to a model.
bool belongs_to_model(const fs::path& file) {
  const auto name = file.filename().string();
  return is_part(file) || name == kText || name == "summary.json" || name == "components.png" ||
         name == "compression.png" || file.extension() == ".npy";
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    found.push_back(entry->path());
  if (error) throw core::IoError("cannot read the folder " + folder.string() + ": " + error.message());
  std::ranges::sort(found);
  return found;
}

const fs::path& checked_place(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return folder;
  // Names that begin with .emberfold- are staging places of runs in progress, or killed.
  const auto there = entries(folder);
  const auto stranger = std::ranges::find_if(there, [](const fs::path& file) {
    return !belongs_to_model(file) && !file.filename().string().starts_with(".emberfold-");
  });
  const bool model =
      std::ranges::any_of(there, [](const fs::path& file) { return file.filename() == kText; });
  const auto first = std::ranges::find_if(there, belongs_to_model);
  if (stranger == there.end() && (model || first == there.end())) return folder;
  throw core::IoError("cannot write a model into " + folder.string() + ": it holds other things (" +
                      (stranger != there.end() ? *stranger : *first).filename().string() +
                      "); give the name of a new folder");
}

bool holds_images(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_image_name(entry->path())) return true;
  return false;
}

// Throws an error that says what a path without model.json is.
[[noreturn]] void refuse(const fs::path& path, std::string_view format) {
  const std::string name = path.string();
  const auto clip = [&] {
    throw core::IoError(name + " is a clip, not a model; learn one with 'emberfold " +
                        (format == kMotionFormat ? "analyze'" : "dytex learn'"));
  };
  std::error_code error;
  const auto status = fs::status(path, error);
  if (name.starts_with("builtin:")) clip();
  if (name.empty()) throw core::IoError("the model's name is empty");
  if (!fs::exists(status)) {
    if (is_pattern(path)) clip();
    throw core::IoError("cannot read " + name + ": " +
                        (error && error != std::errc::no_such_file_or_directory
                             ? error.message()
                             : "there is no such file or folder"));
  }
  if (!fs::is_directory(status)) {
    if (is_image_name(path) || is_video_name(path)) clip();
    if (path.filename() == kText || path.extension() == ".npy")
      throw core::IoError(name + " is one file of a model; give the folder that it is in");
    throw core::IoError(name + " is a file, not a model; a model is a folder with a model.json");
  }
  if (fs::exists(path / "model" / kText, error))
    throw core::IoError(name + " is no model; there is one in it, " + (path / "model").string());
  if (holds_images(path)) clip();
  throw core::IoError(name + " is no model: it has no model.json");
}

std::string read_text(const fs::path& file, std::size_t limit) {
  auto in = open_file(file);
  std::string text(limit + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) throw core::IoError("cannot read " + file.string());
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > limit)
    throw core::IoError(file.string() + " is larger than " + std::to_string(limit) +
                        " bytes, the most that a model may have");
  return text;
}

// Returns the format named in the text; IoError (no prefix) where there is none.
std::string format_of(const std::string& text) {
  const auto json = core::parse_json(text);
  const auto format = json.is_object() ? json.find("format") : json.end();
  if (!json.is_object() || format == json.end() || !format->is_string())
    throw core::IoError("it tells no \"format\", so it is no model of ours");
  return format->get<std::string>();
}

core::NpyArray read_array(const fs::path& file, std::size_t limit) {
  auto in = open_file(file);
  try {
    auto array = core::read_npy(in, limit);
    if (in.peek() != std::ifstream::traits_type::eof())
      throw core::IoError("npy: there is more in the file than its header tells");
    return array;
  } catch (const core::IoError& error) {
    throw core::IoError(file.string() + ": " + error.what());
  }
}

}  // namespace

void write_model(OutputFolder& output, const std::string& name, const core::ModelArchive& archive) {
  core::ModelView model{archive.text, {}};
  for (const auto& [array, values] : archive.arrays) model.arrays.emplace(array, core::view(values));
  write_model(output, name, model);
}

void write_model(const fs::path& folder, const core::ModelArchive& archive) {
  ModelFolder model(folder);
  write_model(model.output(), "", archive);
  model.commit();
}

void write_model(OutputFolder& output, const std::string& name, const core::ModelView& archive) {
  if (!name.empty()) output.make_subfolder(name);
  const std::string prefix = name.empty() ? "" : name + "/";
  output.write(prefix + kText, [&](std::ostream& out) { out << archive.text; });
  for (const auto& [array, values] : archive.arrays)
    output.write(prefix + array + ".npy", [&values = values](std::ostream& out) {
      try {
        core::write_npy_view(out, values);
      } catch (const core::IoError&) {
        out.setstate(std::ios::failbit);  // reported with the file's name and the system's reason
      }
    });
}

ModelFolder::ModelFolder(const fs::path& folder) : output_(checked_place(folder), Existing::all) {}

void ModelFolder::commit() {
  const auto staged = entries(output_.staged(""));
  const auto is_new = [&](const fs::path& file) {
    return std::ranges::any_of(staged, [&](const fs::path& s) { return s.filename() == file.filename(); });
  };
  const auto before = entries(output_.path());
  output_.commit();
  std::error_code ignored;
  for (const auto& file : before)
    if (belongs_to_model(file) && !is_new(file)) fs::remove_all(file, ignored);
}

namespace {

/// Reads the arrays of a folder, which may take `limit` bytes.
std::map<std::string, core::NpyArray> read_arrays(const fs::path& folder, std::size_t limit) {
  std::size_t left = limit;
  std::vector<fs::path> files;
  for (const auto& path : entries(folder)) {
    if (path.extension() != ".npy") continue;
    std::error_code error;
    const auto bytes = fs::file_size(path, error);
    if (error) throw core::IoError("cannot read " + path.string() + ": " + error.message());
    // Counted one by one, as a sum of sizes may overflow.
    if (bytes > left || files.size() == kMostArrays)
      throw core::IoError(folder.string() + ": its arrays are more than " + std::to_string(limit) +
                          " bytes or " + std::to_string(kMostArrays) +
                          " files, the most that a model may have");
    left -= bytes;
    files.push_back(path);
  }
  std::map<std::string, core::NpyArray> arrays;
  for (const auto& path : files) arrays[path.stem().string()] = read_array(path, limit);
  return arrays;
}

void check_format(const fs::path& folder, const std::string& text, std::string_view format) {
  const fs::path file = folder / kText;
  std::string found;
  try {
    found = format_of(text);
  } catch (const core::IoError& error) {
    throw core::IoError(file.string() + ": " + error.what());
  }
  if (found == format) return;
  if (found.starts_with(kFamily)) throw core::IoError(folder.string() + " is " + about_model(found));
  throw core::IoError(file.string() + ": the format " + core::quoted(found) +
                      " is none of ours; expected is \"" + std::string(format) + "\"");
}

}  // namespace

core::ModelArchive read_model(const fs::path& folder, std::string_view format, const ModelLimits& limits) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored) || !fs::exists(folder / kText, ignored)) refuse(folder, format);
  core::ModelArchive archive{read_text(folder / kText, limits.text), {}};
  check_format(folder, archive.text, format);
  archive.arrays = read_arrays(folder, limits.arrays);
  return archive;
}

std::optional<std::string> model_format(const fs::path& folder) {
  std::error_code ignored;
  const fs::path file = folder / kText;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  try {
    const auto format = format_of(read_text(file, ModelLimits{}.text));
    if (format.starts_with(kFamily)) return format;
  } catch (const core::IoError&) {  // the folder then names no format
  }
  return std::nullopt;
}

std::string about_model(std::string_view format) {
  if (format == kMotionFormat) return "a motion model; 'emberfold synth' draws from it";
  if (format == kTextureFormat) return "a linear dynamic texture; 'emberfold dytex synth' draws from it";
  return "a model of another kind, " + core::quoted(format);
}

}  // namespace emberfold::io
