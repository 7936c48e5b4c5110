// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/staged_output.hpp"
#include "core/model_archive.hpp"

namespace emberfold::io {

constexpr std::string_view kTextureFormat = "emberfold.linear_dynamic_texture";
constexpr std::string_view kMotionFormat = "emberfold.motion_model";

/// Writes model.json and NAME.npy for every array into the folder `name` of an output, created if absent; ""
/// is the output's own. Throws core::IoError where something cannot be written.
void write_model(OutputFolder& output, const std::string& name, const core::ModelArchive& archive);
void write_model(OutputFolder& output, const std::string& name, const core::ModelView& model);

/// Writes a model into its own folder, created if absent, all files at once; an older model there is
/// replaced. Throws core::IoError where the folder holds anything but a model, or something cannot be
/// written.
void write_model(const std::filesystem::path& folder, const core::ModelArchive& archive);

/// Writes a model into a folder of its own. Besides the model it may hold a summary.json, a components.png
/// and a compression.png.
class ModelFolder {
 public:
  /// Throws core::IoError where the folder cannot be made, or holds anything but a model.
  explicit ModelFolder(const std::filesystem::path& folder);

  [[nodiscard]] OutputFolder& output() { return output_; }
  /// Puts the model in place and removes the files of an older one.
  void commit();

 private:
  OutputFolder output_;
};

struct ModelLimits {
  std::size_t text = std::size_t{1} << 25;    ///< bytes of model.json
  std::size_t arrays = std::size_t{1} << 34;  ///< bytes of all .npy files together
};

/// Reads the model in a folder. Throws core::IoError, on one line and naming the file: there is none, it is a
/// clip, it is a model of another format (with the command that takes it), it is larger than the limits, it
/// is cut off or its content is not what its names promise.
core::ModelArchive read_model(const std::filesystem::path& folder, std::string_view format,
                              const ModelLimits& limits = {});

/// Returns the format that the model.json in a folder names, if it is "emberfold.…"; nothing where there is
/// no such file or it cannot be read.
std::optional<std::string> model_format(const std::filesystem::path& folder);

/// Describes a format: "a motion model; 'emberfold synth' draws from it".
std::string about_model(std::string_view format);

}  // namespace emberfold::io
