// SPDX-License-Identifier: Apache-2.0
#include "apps/files.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {
[[noreturn]] void fail(const char* action, const fs::path& path, const std::string& reason) {
  throw core::IoError(std::string("cannot ") + action + " " + path.string() + ": " + reason);
}
}  // namespace

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) fail("make the folder", path, error.message());
  if (!fs::is_directory(path)) fail("make the folder", path, "a file has this name");
}

std::ifstream open_file(const fs::path& path) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path))
    fail("read", path, fs::is_directory(path) ? "it is a folder" : std::strerror(errno));
  return in;
}

bool is_video_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* known : {".mp4", ".avi", ".mov", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".wmv", ".flv",
                            ".y4m", ".ogv", ".ts", ".3gp"})
    if (extension == known) return true;
  return false;
}

}  // namespace emberfold::apps
