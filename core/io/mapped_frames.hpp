// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "core/io/mapped_memory.hpp"

namespace emberfold::io {

/// Allocates `bytes` bytes for a chunk of frames; they live as long as the allocator.
using ChunkMemory = std::function<std::byte*(int chunk, std::size_t bytes)>;

/// Allocates memory for trajectories: from the heap up to a limit, beyond it from a file that is mapped into
/// memory. The file has no name and vanishes with this object, however the program ends. The memory lives as
/// long as this object.
class MappedFrames {
 public:
  /// Puts the file into `folder` once it is needed.
  MappedFrames(std::filesystem::path folder, std::size_t heap_bytes)
      : mapped_(std::move(folder)), heap_left_(heap_bytes) {}

  /// Returns the allocator. It throws core::IoError where the disk is full.
  [[nodiscard]] ChunkMemory memory();
  [[nodiscard]] std::size_t mapped_bytes() const { return mapped_.used_bytes(); }

 private:
  MappedMemory mapped_;
  std::size_t heap_left_;
  std::vector<std::vector<std::byte>> heap_;
};

}  // namespace emberfold::io
