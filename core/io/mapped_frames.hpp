// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

namespace emberfold::io {

/// Gives memory for a chunk of frames: `bytes` bytes that live as long as the giver.
using ChunkMemory = std::function<std::byte*(int chunk, std::size_t bytes)>;

/// Memory for trajectories: from the heap up to a limit, beyond it from a file that is mapped into memory, of
/// which the system keeps as much in memory as there is room for. The file has no name: it vanishes with this
/// object, however the program ends. What was handed out lives as long as this.
class MappedFrames {
 public:
  /// The file will lie in `folder`.
  MappedFrames(std::filesystem::path folder, std::size_t heap_bytes);
  ~MappedFrames();
  MappedFrames(const MappedFrames&) = delete;
  MappedFrames& operator=(const MappedFrames&) = delete;

  /// core::IoError where the disk has no room.
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
