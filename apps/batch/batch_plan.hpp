// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace emberfold::apps {

/// A clip, and the folder of its run below the output.
struct PlannedRun {
  std::string clip;
  std::string name;  ///< "wild/a" for clips/wild/a.avi, where clips/ is the folder that holds all of them
  bool operator==(const PlannedRun&) const = default;
};

/// Finds the clips that the words name, and names their runs.
/// A word is a clip (a file, a folder of images, builtin:NAME), a folder without single images, which stands
/// for all videos, TIFF stacks and folders of images in it, or a shell pattern. Runs are sorted by name;
/// repeated clips are listed once. Names have no extension, unless two clips differ by it alone. Throws
/// core::InputError for a word that names nothing, a pipe, a folder of both stacks and single images, or a
/// pattern that matches single images (frames of one clip).
std::vector<PlannedRun> plan_runs(const std::vector<std::string>& words);

}  // namespace emberfold::apps
