// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace emberfold::io {

/// Returns a hidden name in the folder for a file or folder that is not whole yet. No other process or call
/// has it, also on another machine that shares the disk, so that two runs that write to one name do not mix.
/// `suffix` ends it. What processes of this machine left under such names when they were killed is removed
/// from the folder.
std::filesystem::path scratch_path(const std::filesystem::path& folder, const std::string& suffix = {});

}  // namespace emberfold::io
