// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex::detail {

/// Frames: the most that are compared at once. Beyond, τ × τ decompositions take many minutes.
constexpr std::size_t kMostFrames = 5000;
/// Bytes: the smallest memory for frames that may be requested.
constexpr double kLeastMemory = 1 << 20;

/// Returns the number of values of a clip's frame: m. InputError where it is 0.
std::size_t value_count(const core::ClipInfo& info);
/// Reads a source's next frame, stored without gaps; an empty one after the last. IoError, which gives
/// `index`, where its size or type differs from the source's.
cv::Mat next_frame(core::FrameSource& source, std::size_t index);
/// Throws InputError where a clip has fewer than 2 frames.
void check_least_frames(std::size_t frames);

/// Reads a source's frames in blocks of their values, of which one at a time is in memory. A clip that fits
/// in memory is a single block, read once and kept.
class FrameBlocks {
 public:
  /// Reads the clip once to keep or to count it. `memory`: bytes for frames; at least one block of every
  /// frame is held. Throws InputError where there are fewer than 2 or more than `most_frames` frames; IoError
  /// where a frame's size or type differs from the source's.
  FrameBlocks(core::FrameSource& source, std::size_t memory, std::size_t most_frames,
              const core::Context& context);

  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t values() const { return values_; }  ///< of a frame: m
  [[nodiscard]] int passes() const { return passes_; }          ///< over the source up to now

  /// Calls body(first value, values) for every block. `backwards` begins with the last one, which is still in
  /// memory after a forward call. `stage` is reported to the context. IoError where the source does not give
  /// the same number of frames again.
  void for_each(const char* stage, bool backwards,
                const std::function<void(std::size_t, const FrameValues&)>& body,
                const core::Context& context);
  /// Calls body(first frame, all values of some frames) for batches of `batch` frames and the rest. A clip
  /// that is kept comes at once; else the source is read again, while no block is in memory.
  void for_each_batch(const char* stage, std::size_t batch,
                      const std::function<void(std::size_t, const FrameValues&)>& body,
                      const core::Context& context);
  /// Frees the block in memory. A clip that is kept whole stays.
  void release();
  [[nodiscard]] bool keeps_all() const { return !kept_.empty(); }

 private:
  void plan(std::size_t frames, std::size_t memory);
  void keep_part(const cv::Mat& frame, std::size_t index);
  void load(std::size_t index, const core::Context& context);
  cv::Mat next_again(std::size_t index);  // of a clip that was read before

  core::FrameSource& source_;
  std::size_t frames_ = 0, values_ = 0, value_bytes_ = 1, block_values_ = 0, block_count_ = 1;
  std::size_t loaded_ = 0;                         // the block in memory
  std::vector<cv::Mat> kept_;                      // whole frames, where all fit
  std::vector<std::vector<unsigned char>> parts_;  // else each frame's values of that block
  int passes_ = 0;
};

}  // namespace emberfold::dytex::detail
