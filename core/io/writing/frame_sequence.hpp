// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "core/io/clip_writer.hpp"

namespace emberfold::io {

/// The names of the frames of a clip that is a folder of pictures.
struct SequenceName {
  std::filesystem::path folder;  ///< absolute
  std::string pattern;           ///< of the files in it: a printf number such as %05d, and .png or .exr
};

/// Returns what a name stands for: a folder of frame_%05d.png where it has no extension, and the pattern and
/// its folder where its last part is one. Nothing for any other name. Throws core::InputError for a pattern
/// without a folder before it, of more than one number, or of another picture than PNG and EXR.
std::optional<SequenceName> sequence_name(const std::filesystem::path& path);

/// Creates the writer of such a clip; see create_video().
std::unique_ptr<VideoWriter> create_sequence(SequenceName name, cv::Size size, bool colour);

}  // namespace emberfold::io
