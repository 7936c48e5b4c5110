// SPDX-License-Identifier: Apache-2.0
#include "apps/batch/batch_plan.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <system_error>

#include <glob.h>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/image_files.hpp"
#include "core/io/reading/image_series.hpp"
#include "core/io/tiff_pages.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBuiltin = "builtin:";

bool is_hidden(const fs::path& path) {
  return path.filename().string().starts_with('.');
}

struct FolderImages {
  std::vector<std::string> images;  ///< frames of one clip, unless there are stacks
  std::vector<std::string> stacks;  ///< TIFFs of several pages, each a clip
};

FolderImages pictures_in(const fs::path& folder) {
  FolderImages found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (!is_hidden(entry.path()) && io::is_image_name(entry.path()))
      (io::pages_alike(entry.path()) > 1 ? found.stacks : found.images).push_back(entry.path().string());
  if (!found.stacks.empty() && !found.images.empty())
    throw core::InputError(folder.string() + " holds TIFF stacks (" +
                           fs::path(found.stacks.front()).filename().string() + ") and single images (" +
                           fs::path(found.images.front()).filename().string() +
                           "); name the stacks, or move the images into a folder of their own");
  return found;
}

/// Returns whether the images of a folder are the frames of one clip.
bool is_series(const fs::path& folder) {
  return !pictures_in(folder).images.empty();
}

/// Returns the clips below a folder: videos, TIFF stacks, and folders of images.
std::vector<std::string> clips_below(const fs::path& folder) {
  std::vector<std::string> found = pictures_in(folder).stacks;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_hidden(entry.path())) continue;
    if (entry.is_directory(error)) {
      if (is_series(entry.path())) {
        found.push_back(entry.path().string());
        continue;
      }
      const auto inner = clips_below(entry.path());
      found.insert(found.end(), inner.begin(), inner.end());
    } else if (io::is_video_name(entry.path())) {
      found.push_back(entry.path().string());
    }
  }
  return found;
}

std::vector<std::string> matches(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> paths;
  if (::glob(pattern.c_str(), GLOB_BRACE | GLOB_TILDE, nullptr, &found) == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i) paths.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  return paths;
}

/// Returns the clips that one path names.
std::vector<std::string> clips_of(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error) || is_series(path)) return {path};
  return clips_below(path);
}

std::vector<std::string> clips_meant(const std::string& word) {
  if (word.starts_with(kBuiltin)) return {word};
  if (word == "-") throw core::InputError("a pipe (-) is no clip for batch: name files");
  std::error_code error;
  if (fs::exists(word, error)) {
    auto clips = clips_of(word);
    if (clips.empty())
      throw core::InputError(word + " holds no clip: no images, and no video or TIFF stack below it");
    return clips;
  }
  std::vector<std::string> clips;
  for (const auto& path : matches(word)) {
    if (io::is_image_name(path) && !io::is_tiff(path) && !fs::is_directory(path, error))
      throw core::InputError(word + " fits single images, the frames of a clip; name their folders");
    const auto inner = clips_of(path);
    clips.insert(clips.end(), inner.begin(), inner.end());
  }
  if (clips.empty()) throw core::InputError(word + " fits no file or folder");
  return clips;
}

fs::path whole_path(const std::string& clip) {
  fs::path path = fs::absolute(clip).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

/// Returns the innermost folder that holds all these paths.
fs::path common_folder(const std::vector<fs::path>& paths) {
  fs::path common;
  for (const auto& path : paths) {
    const fs::path folder = path.parent_path();
    if (common.empty()) common = folder;
    const auto [own, other] = std::mismatch(common.begin(), common.end(), folder.begin(), folder.end());
    fs::path shared;
    for (auto part = common.begin(); part != own; ++part) shared /= *part;
    common = shared;
  }
  return common;
}

}  // namespace

std::vector<PlannedRun> plan_runs(const std::vector<std::string>& words) {
  std::vector<PlannedRun> runs;
  std::vector<fs::path> paths;
  std::vector<std::string> clips;
  std::set<std::string> seen;
  for (const auto& word : words)
    for (const auto& clip : clips_meant(word)) {
      if (clip.starts_with(kBuiltin)) {
        if (seen.insert(clip).second) runs.push_back({clip, clip.substr(kBuiltin.size())});
      } else if (seen.insert(whole_path(clip).string()).second) {
        clips.push_back(clip), paths.push_back(whole_path(clip));
      }
    }
  const fs::path common = common_folder(paths);
  std::map<std::string, int> uses;
  const auto short_name = [&](const fs::path& path) {
    std::error_code error;
    const fs::path name = path.lexically_relative(common);
    return fs::is_directory(path, error) ? name.string() : fs::path(name).replace_extension().string();
  };
  for (const auto& run : runs) ++uses[run.name];
  for (const auto& path : paths) ++uses[short_name(path)];
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto name = short_name(paths[i]);
    runs.push_back({clips[i], uses[name] > 1 ? paths[i].lexically_relative(common).string() : name});
  }
  std::ranges::sort(runs, {}, &PlannedRun::name);
  return runs;
}

}  // namespace emberfold::apps
