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

/// All frames of a source, band by band of their values, of which only one is in memory. A clip that fits is
/// a single band, read once and kept.
class FrameBands {
 public:
  /// Reads the clip once to keep or to count it. `memory`: bytes for frames; at least one block of every
  /// frame is held. InputError where there are fewer than 2 or more than `most_frames` frames; IoError where
  /// a frame has another size or type than the source tells. Cancelled: frames() is 0.
  FrameBands(core::FrameSource& source, std::size_t memory, std::size_t most_frames,
             const core::Context& context);

  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t values() const { return values_; }  ///< of a frame: m
  [[nodiscard]] int passes() const { return passes_; }          ///< over the source up to now

  /// Calls body(first value, values) for every band; `backwards` begins with the last one, which is still in
  /// memory after a forward call. `stage` is reported to the context. IoError where the source does not give
  /// the same number of frames again.
  core::Status for_each(const char* stage, bool backwards,
                        const std::function<core::Status(std::size_t, const FrameValues&)>& body,
                        const core::Context& context);
  /// Calls body(first frame, all values of some frames) for whole batches of `batch` frames and the rest: at
  /// once for a clip that is kept, else in another pass over the source, in which no band is in memory.
  core::Status for_each_batch(const char* stage, std::size_t batch,
                              const std::function<core::Status(std::size_t, const FrameValues&)>& body,
                              const core::Context& context);
  /// Lets go of the band in memory; a clip that is kept whole stays.
  void release();
  [[nodiscard]] bool whole() const { return !kept_.empty(); }

 private:
  void plan(std::size_t frames, std::size_t memory);
  void keep_part(const cv::Mat& frame, std::size_t band);
  core::Status load(std::size_t band, const core::Context& context);
  cv::Mat next_frame(std::size_t index);
  cv::Mat next_again(std::size_t index);  // of a clip that was read before

  core::FrameSource& source_;
  std::size_t frames_ = 0, values_ = 0, value_bytes_ = 1, band_values_ = 0, bands_ = 1;
  std::size_t loaded_ = 0;                         // the band in memory
  std::vector<cv::Mat> kept_;                      // whole frames, where all fit
  std::vector<std::vector<unsigned char>> parts_;  // else each frame's values of that band
  int passes_ = 0;
};

}  // namespace emberfold::dytex::detail
