// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <iosfwd>
#include <string>

namespace emberfold::io {

/// Makes the folder and those above it. Throws core::IoError where it cannot, or a file has this name.
void make_folder(const std::filesystem::path& path);

/// Opens a file for reading. Throws core::IoError with the path and the system's reason.
std::ifstream open_file(const std::filesystem::path& path);

/// Returns whether the name has the extension of a video.
bool is_video_name(const std::filesystem::path& path);

/// Writes a file under a temporary name. finish() gives it its own; without finish() it is removed.
/// The constructor throws core::IoError, with the path and the reason, where the file cannot be written.
class StagedFile {
 public:
  explicit StagedFile(std::filesystem::path path);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// Writes the content through a stream and checks that all of it arrived.
  void write(const std::function<void(std::ostream&)>& body) const;
  void finish() const;

 private:
  std::filesystem::path path_, part_;
};

}  // namespace emberfold::io
