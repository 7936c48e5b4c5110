// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::dytex {

/// Provides memory for chunk number `chunk`, `bytes` long, that stays valid as long as the trajectories live.
/// It may be part of a mapped file.
using ChunkMemory = std::function<std::byte*(int chunk, std::size_t bytes)>;

/// The pixels p(x, y, t) of a time-lapse, stored so that the values of a pixel over time are contiguous: the
/// frames in chunks, in a chunk pixel after pixel (row by row), in a pixel frame after frame, in a frame the
/// channels. The rest of the last chunk is zero. Copies and comparisons of blocks over all of time run
/// through it chunk by chunk.
class Trajectories {
 public:
  /// No frames yet; memory from the heap unless `memory` gives it. `chunk_frames`: at least 1, or 0 for
  /// chunk_length(); sources of one quilt need the same.
  explicit Trajectories(const core::ClipInfo& info, ChunkMemory memory = {}, int chunk_frames = 0);
  Trajectories(Trajectories&&) = default;
  Trajectories& operator=(Trajectories&&) = default;

  /// Adds the next frame: of the size, channels and depth of info(), else InputError.
  void add(const cv::Mat& frame);
  /// Ends the adding of frames. Throws InputError where there was none.
  void finish();

  [[nodiscard]] const core::ClipInfo& info() const { return info_; }
  [[nodiscard]] cv::Size size() const { return {info_.width, info_.height}; }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] int chunk_frames() const { return chunk_frames_; }
  [[nodiscard]] int chunks() const { return static_cast<int>(chunks_.size()); }
  [[nodiscard]] const std::byte* chunk(int index) const { return chunks_[static_cast<std::size_t>(index)]; }
  /// Returns the values of a pixel in a chunk: chunk_frames · channels.
  [[nodiscard]] std::size_t course() const {
    return static_cast<std::size_t>(chunk_frames_) * static_cast<std::size_t>(info_.channels);
  }
  /// Returns the values of a pixel over all of time: d = frames · channels.
  [[nodiscard]] std::size_t dimension() const {
    return static_cast<std::size_t>(frames_) * static_cast<std::size_t>(info_.channels);
  }
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(info_.width) * static_cast<std::size_t>(info_.height);
  }

 private:
  void flush();

  core::ClipInfo info_;
  ChunkMemory memory_;
  int frames_ = 0, chunk_frames_ = 1;
  std::vector<cv::Mat> pending_;
  std::vector<const std::byte*> chunks_;
  std::vector<std::vector<std::byte>> heap_;
};

/// Packs at most a chunk's frames in the order of a chunk. `out` holds course · pixels values.
void pack_chunk(const std::vector<cv::Mat>& frames, int chunk_frames, std::byte* out);

/// Returns the number of frames in a chunk: 16, fewer where frames are large (64 MB a chunk).
int chunk_length(const core::ClipInfo& info);

/// Reads all frames of a source, from its first.
Trajectories read_trajectories(core::FrameSource& source, ChunkMemory memory = {},
                               const core::Context& context = {}, int chunk_frames = 0);

}  // namespace emberfold::dytex
