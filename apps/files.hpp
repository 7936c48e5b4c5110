// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

namespace emberfold::apps {

/// Makes the folder and those above it; core::IoError where it cannot, or where something else has its name.
void make_folder(const std::filesystem::path& path);

/// Opens a file for reading; core::IoError, with the path and the system's reason, where it cannot.
std::ifstream open_file(const std::filesystem::path& path);

/// Whether the name's extension is that of a video.
bool is_video_name(const std::filesystem::path& path);

}  // namespace emberfold::apps
