// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace emberfold::io {

/// Returns a hidden name in the folder for a file or folder in progress. The name is unique among processes
/// and calls, also on other machines that share the disk, so that two runs that write to one name do not mix.
/// `suffix` ends it. Removes from the folder what killed processes of this machine left under such names.
std::filesystem::path scratch_path(const std::filesystem::path& folder, const std::string& suffix = {});

}  // namespace emberfold::io
