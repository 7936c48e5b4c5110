// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/io/clip_reader.hpp"

namespace emberfold::test {

/// Reads a whole clip.
inline core::Clip read_clip(const std::filesystem::path& path, const io::ReadOptions& options = {},
                            const core::Warn& warn = {}) {
  return core::read_all(*io::open_video(path.string(), options, warn));
}

}  // namespace emberfold::test
