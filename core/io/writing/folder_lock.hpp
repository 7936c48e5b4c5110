// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

namespace emberfold::io {

/// Keeps other processes from writing their results into a folder, until the last copy is gone or the process
/// ends in any way. Calls of one process share the lock. Leaves no file. File systems that lock no folders
/// (some network disks) are written without it.
class FolderLock {
 public:
  FolderLock() = default;
  /// Throws core::IoError where another process holds the folder.
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  std::shared_ptr<const int> held_;
};

}  // namespace emberfold::io
