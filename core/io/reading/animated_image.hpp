// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace emberfold::io {

/// Kind of animation of an image file.
struct Animation {
  enum class Kind { none, apng, webp };
  Kind kind = Kind::none;
  int frames = 1;  ///< as the file's head or its list of chunks says
};

/// Reads the heads of a PNG's or WebP's chunks. Files of other kinds and unreadable ones are no animation.
Animation read_animation(const std::filesystem::path& path);

}  // namespace emberfold::io
