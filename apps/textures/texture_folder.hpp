// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// Reads a linear dynamic texture. Throws IoError naming the folder.
dytex::LinearDynamicTexture read_texture(const std::string& folder);

/// A texture and its edits since it was learned.
struct TextureAndEdits {
  dytex::LinearDynamicTexture texture;
  std::vector<std::string> edits;  ///< as in apps/textures/texture_edits.hpp
};
/// Reads a texture and its edits. Throws IoError naming the folder.
TextureAndEdits read_texture_and_edits(const std::string& folder);

}  // namespace emberfold::apps
