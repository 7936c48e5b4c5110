// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/folder_lock.hpp"

#include <cerrno>
#include <map>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.hpp"

namespace emberfold::io {

namespace {

using FolderId = std::pair<dev_t, ino_t>;

/// The locks that this process holds.
struct Held {
  std::mutex mutex;
  std::map<FolderId, std::weak_ptr<const int>> locks;
};

Held& held() {
  static Held one;
  return one;
}

void release(const int* file) {
  ::close(*file);
  delete file;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::shared_ptr<const int> file(new int(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)),
                                        release);
  struct stat found {};
  if (*file < 0 || ::fstat(*file, &found) != 0) return;  // writing into it reports why
  const std::scoped_lock lock(held().mutex);
  auto& known = held().locks[{found.st_dev, found.st_ino}];
  held_ = known.lock();
  if (held_) return;
  if (::flock(*file, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return;
    throw core::IoError("another emberfold is writing into " + folder.string() +
                        "; wait for its end, or give another folder");
  }
  held_ = file;
  known = held_;
}

}  // namespace emberfold::io
