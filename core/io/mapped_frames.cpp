// SPDX-License-Identifier: Apache-2.0
#include "core/io/mapped_frames.hpp"

namespace emberfold::io {

ChunkMemory MappedFrames::memory() {
  return [this](int, std::size_t bytes) {
    if (bytes > heap_left_) return static_cast<std::byte*>(mapped_.allocate(bytes));
    heap_left_ -= bytes;
    return heap_.emplace_back(bytes).data();
  };
}

}  // namespace emberfold::io
