// SPDX-License-Identifier: Apache-2.0
#include "core/io/files.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <system_error>
#include <utility>

#include "core/error.hpp"
#include "core/io/scratch.hpp"

namespace emberfold::io {

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
    fail("read", path, fs::is_directory(path) ? "it is a folder" : std::generic_category().message(errno));
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

StagedFile::StagedFile(fs::path path) : path_(std::move(path)), part_(scratch_path(path_.parent_path())) {
  if (fs::is_directory(path_)) fail("write", path_, "a folder has this name");
  errno = 0;
  if (!std::ofstream(part_, std::ios::binary | std::ios::trunc))
    fail("write", path_, std::generic_category().message(errno));
}

StagedFile::~StagedFile() {
  std::error_code ignored;
  fs::remove(part_, ignored);
}

void StagedFile::write(const std::function<void(std::ostream&)>& body) const {
  errno = 0;
  std::ofstream stream(part_, std::ios::binary | std::ios::trunc);
  const auto stopped = [&] {
    fail("write", path_, errno != 0 ? std::generic_category().message(errno) : "the disk may be full");
  };
  try {
    body(stream);
  } catch (const core::IoError&) {
    if (!stream) stopped();  // the writer does not know the file or the reason
    throw;
  }
  stream.close();
  if (!stream) stopped();
}

void StagedFile::finish() const {
  std::error_code error;
  fs::rename(part_, path_, error);
  if (error) fail("write", path_, error.message());
}

}  // namespace emberfold::io
