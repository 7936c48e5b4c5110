// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "dytex/quilt_trajectories.hpp"

namespace emberfold::apps {

/// Memory for trajectories: from the heap up to a limit, beyond it from a file that is mapped into memory, of
/// which the system keeps as much in memory as there is room for. The file has no name: it vanishes with this
/// object, however the program ends. What was handed out lives as long as this.
class MappedCache {
 public:
  /// The file will lie in `folder`.
  MappedCache(std::filesystem::path folder, std::size_t heap_bytes);
  ~MappedCache();
  MappedCache(const MappedCache&) = delete;
  MappedCache& operator=(const MappedCache&) = delete;

  /// core::IoError where the disk has no room.
  [[nodiscard]] dytex::ChunkMemory memory();
  [[nodiscard]] std::size_t mapped_bytes() const { return end_; }

 private:
  std::byte* map(std::size_t bytes);

  std::filesystem::path folder_;
  std::size_t heap_left_, end_ = 0;
  int file_ = -1;
  std::vector<std::vector<std::byte>> heap_;
  std::vector<std::pair<void*, std::size_t>> maps_;
};

}  // namespace emberfold::apps
