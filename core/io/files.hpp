// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <iosfwd>
#include <string>

namespace emberfold::io {

/// Makes the folder and those above it; core::IoError where it cannot, or where something else has its name.
void make_folder(const std::filesystem::path& path);

/// Opens a file for reading; core::IoError, with the path and the system's reason, where it cannot.
std::ifstream open_file(const std::filesystem::path& path);

/// Whether the name's extension is that of a video.
bool is_video_name(const std::filesystem::path& path);

/// A file that is written beside its name and takes it in the end; without finish() nothing stays of it.
/// core::IoError, with the path and the reason, where it cannot be written, found when it is made.
class StagedFile {
 public:
  explicit StagedFile(std::filesystem::path path);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// Writes all of it through a stream and checks that all arrived.
  void write(const std::function<void(std::ostream&)>& body) const;
  void finish() const;

 private:
  std::filesystem::path path_, part_;
};

}  // namespace emberfold::io
