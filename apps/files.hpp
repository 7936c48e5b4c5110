// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

namespace emberfold::apps {

/// A file that appears under its name only when it is whole: written beside (`NAME.part`), renamed by
/// commit(), removed if commit() is not reached. core::IoError, with the path and the system's reason, where
/// it cannot be opened, written or renamed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return stream_; }
  void commit();

 private:
  std::filesystem::path path_, part_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// Makes the folder and those above it; core::IoError where it cannot, or where something else has its name.
void make_folder(const std::filesystem::path& path);

/// Opens a file for reading; core::IoError, with the path and the system's reason, where it cannot.
std::ifstream open_file(const std::filesystem::path& path);

}  // namespace emberfold::apps
