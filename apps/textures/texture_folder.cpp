// SPDX-License-Identifier: Apache-2.0
#include "apps/textures/texture_folder.hpp"

#include "apps/textures/texture_edits.hpp"
#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"

namespace emberfold::apps {

TextureAndEdits read_texture_and_edits(const std::string& folder) {
  const auto archive = io::read_model(folder, io::kTextureFormat);
  try {
    return {dytex::linear_dynamic_texture(archive), edit_history(archive.text)};
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
}

dytex::LinearDynamicTexture read_texture(const std::string& folder) {
  return read_texture_and_edits(folder).texture;
}

}  // namespace emberfold::apps
