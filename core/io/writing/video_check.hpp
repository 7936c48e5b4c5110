// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace emberfold::io {

/// Returns whether the parts of an AVI file (RIFF chunks) or an MP4 file (boxes, a `moov` among them), by its
/// extension, fill the file to its last byte. A muxer whose disk was full leaves a file that fails this.
/// Cost: one seek for each part, of which there are few.
bool video_is_whole(const std::filesystem::path& path);

}  // namespace emberfold::io
