// SPDX-License-Identifier: Apache-2.0
#include "apps/texture_folder.hpp"

#include "apps/model_folder.hpp"
#include "core/error.hpp"
#include "dytex/archive.hpp"

namespace emberfold::apps {

dytex::LinearDynamicTexture read_texture(const std::string& folder) {
  const auto archive = read_model(folder, kTextureFormat);
  try {
    return dytex::linear_dynamic_texture(archive);
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
}

}  // namespace emberfold::apps
