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
constexpr std::string_view kDictionaryFormat = "emberfold.dictionary";
constexpr std::string_view kMotionFormat = "emberfold.motion_model";

/// Writes model.json and NAME.npy for every array into the folder `name` of an output, made where it is not
/// there; "" is the output's own. core::IoError where something cannot be written.
void write_model(OutputFolder& output, const std::string& name, const core::ModelArchive& archive);
void write_model(OutputFolder& output, const std::string& name, const core::ModelView& model);

/// Writes a model into its own folder, made where it is not there, all files at once; an older model there is
/// replaced. core::IoError where the folder holds other things than a model, or something cannot be written.
void write_model(const std::filesystem::path& folder, const core::ModelArchive& archive);

/// A model's own folder while it is written. Beside the model it may hold a summary.json, a
/// components.png and a compression.png.
class ModelFolder {
 public:
  /// core::IoError where the folder can be none, or already holds other things than a model.
  explicit ModelFolder(const std::filesystem::path& folder);

  [[nodiscard]] OutputFolder& output() { return output_; }
  /// Puts what was written in place; what an older model left there goes.
  void commit();

 private:
  OutputFolder output_;
};

struct ModelLimits {
  std::size_t text = std::size_t{1} << 25;    ///< bytes of model.json
  std::size_t arrays = std::size_t{1} << 34;  ///< bytes of all .npy files together
  bool parts = true;                          ///< read the models in folders below, too
};

/// The model in a folder, if it is of this format. core::IoError, on one line and naming the file: there is
/// none, it is a clip, it is a model of another format (with the command that takes it), it is larger than
/// the limits, it is cut off or holds something else than its names promise.
core::ModelArchive read_model(const std::filesystem::path& folder, std::string_view format,
                              const ModelLimits& limits = {});

/// What the model.json in a folder calls itself, if that is a format of ours: "emberfold.…". Nothing where
/// there is no such folder or file, or it cannot be read.
std::optional<std::string> model_format(const std::filesystem::path& folder);

/// "a motion model; 'emberfold synth' draws from it"
std::string about_model(std::string_view format);

}  // namespace emberfold::io
