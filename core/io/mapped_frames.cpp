// SPDX-License-Identifier: Apache-2.0
#include "core/io/mapped_frames.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/error.hpp"

namespace emberfold::io {

MappedFrames::MappedFrames(std::filesystem::path folder, std::size_t heap_bytes)
    : folder_(std::move(folder)), heap_left_(heap_bytes) {
  if (folder_.empty()) folder_ = ".";
}

MappedFrames::~MappedFrames() {
  for (const auto& [address, bytes] : maps_) ::munmap(address, bytes);
  if (file_ >= 0) ::close(file_);
}

ChunkMemory MappedFrames::memory() {
  return [this](int, std::size_t bytes) {
    if (bytes > heap_left_) return map(bytes);
    heap_left_ -= bytes;
    return heap_.emplace_back(bytes).data();
  };
}

std::byte* MappedFrames::map(std::size_t bytes) {
  const auto fail = [&](int reason) {
    throw core::IoError("cannot keep the clip in a file in " + folder_.string() + ": " +
                        std::strerror(reason));
  };
  if (file_ < 0) {
    std::string name = (folder_ / ".emberfold-cache-XXXXXX").string();
    file_ = ::mkstemp(name.data());
    if (file_ < 0) fail(errno);
    ::unlink(name.c_str());
  }
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t length = (bytes + page - 1) / page * page;
  // Room is taken now: a page that finds none later would end the program.
  const int reason = ::posix_fallocate(file_, static_cast<off_t>(end_), static_cast<off_t>(length));
  if (reason != 0) fail(reason);
  void* const address =
      ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file_, static_cast<off_t>(end_));
  if (address == MAP_FAILED) fail(errno);
  maps_.emplace_back(address, length);
  end_ += length;
  return static_cast<std::byte*>(address);
}

}  // namespace emberfold::io
