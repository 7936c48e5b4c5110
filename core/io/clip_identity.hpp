// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace emberfold::io {

/// Returns a text that changes when the files of a clip do: the sizes, times of last change and content (of
/// large files nine samples of 16 KiB from head to tail) of the file, or of all images of a folder or
/// pattern, with their names. The clip's own path is not included, so that it may be moved. Empty for a pipe,
/// whose content is unknown, and for names that do not exist.
std::string clip_identity(const std::string& name);

}  // namespace emberfold::io
