// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// The linear dynamic texture in a folder; IoError that names the folder.
dytex::LinearDynamicTexture read_texture(const std::string& folder);

}  // namespace emberfold::apps
