// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// The linear dynamic texture in a folder; IoError that names the folder.
dytex::LinearDynamicTexture read_texture(const std::string& folder);

struct TextureAndEdits {
  dytex::LinearDynamicTexture texture;
  std::vector<std::string> edits;  ///< as apps/textures/texture_edits.hpp tells
};
TextureAndEdits read_texture_and_edits(const std::string& folder);

}  // namespace emberfold::apps
