// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"

namespace emberfold::pipeline {

/// Blocks of memory that images lie in, which live as long as these.
using ImageBlocks = std::vector<std::shared_ptr<const void>>;

/// Returns a copy of an image in memory for large data, whose block is added to `blocks`; the image itself
/// where there is none (null).
inline cv::Mat kept_image(const cv::Mat& image, const core::LargeMemory& memory, ImageBlocks& blocks) {
  if (memory == nullptr || image.empty()) return image;
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  const std::size_t bytes = whole.total() * whole.elemSize();
  void* const block = memory->allocate(bytes, alignof(std::max_align_t));
  blocks.emplace_back(block, [memory, bytes](const void* at) {
    memory->deallocate(const_cast<void*>(at), bytes, alignof(std::max_align_t));
  });
  std::memcpy(block, whole.data, bytes);
  return {whole.rows, whole.cols, whole.type(), block};
}

}  // namespace emberfold::pipeline
