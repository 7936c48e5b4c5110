// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

namespace emberfold::io {

/// Allocates `bytes` bytes for a chunk of frames; they live as long as the allocator.
using ChunkMemory = std::function<std::byte*(int chunk, std::size_t bytes)>;

/// Allocates memory for trajectories: from the heap up to a limit, beyond it from a file that is mapped into
/// memory. The file has no name and vanishes with this object, however the program ends. The memory lives as
/// long as this object.
class MappedFrames {
 public:
  /// Puts the file into `folder` once it is needed.
  MappedFrames(std::filesystem::path folder, std::size_t heap_bytes);
  ~MappedFrames();
  MappedFrames(const MappedFrames&) = delete;
  MappedFrames& operator=(const MappedFrames&) = delete;

  /// Returns the allocator. It throws core::IoError where the disk is full.
  [[nodiscard]] ChunkMemory memory();
  [[nodiscard]] std::size_t mapped_bytes() const { return end_; }

 private:
  std::byte* map(std::size_t bytes);

  std::filesystem::path folder_;
  std::size_t heap_left_, end_ = 0;
  int file_ = -1;
  std::vector<std::vector<std::byte>> heap_;
  std::vector<std::pair<void*, std::size_t>> maps_;
};

}  // namespace emberfold::io
