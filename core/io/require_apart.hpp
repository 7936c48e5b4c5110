// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace emberfold::io {

/// Reports that an output would replace an input.
class OverwriteError : public core::InputError {
 public:
  using core::InputError::InputError;
};

/// A path that a command is going to write.
struct OutputPath {
  std::filesystem::path path;
  /// True: files are added to the folder. False: `path` is replaced whole, a folder with all its content.
  bool is_folder = false;
};

/// Returns what an output replaces: of a pattern of frames (dir/new_%05d.png) its folder, else itself.
std::filesystem::path replaced_path(const std::filesystem::path& output);

/// Throws OverwriteError, naming both, where an output is an input. Files are compared by device and inode,
/// so that symbolic links, hard links and other spellings are found. An input is a file; a folder, which
/// stands for the files in it; the folder of a model, which stands for all below it too; or a pattern of
/// images (dir/img_*.png), which stands for its folder and the files that fit. Empty names, "builtin:" clips
/// and names that do not exist are skipped. Refused are: an output that is an input; a folder that is
/// replaced and holds an input; an output folder that is an input folder; an image written into a folder of
/// images that is read; two outputs of one name.
void require_apart(const std::vector<std::string>& inputs, const std::vector<OutputPath>& outputs);

}  // namespace emberfold::io
