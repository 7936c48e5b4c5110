// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/distributed/communicator.hpp"
#include "dytex/distributed/stripes.hpp"

namespace emberfold::dytex {

/// A clip that ranks read in turns.
struct SharedClip {
  core::ClipInfo info;                  ///< the same on all ranks
  int readers = 1;                      ///< ranks 0 … readers − 1 read; above 1, info.frames is exact
  core::FrameSource* source = nullptr;  ///< on those ranks
};

/// Receives a stripe's values of some frames, one frame after the other: (stripe, first frame, bytes).
using PutValues = std::function<void(std::size_t, std::size_t, std::span<const std::byte>)>;

/// Reads a clip in rounds: each reader decodes a range of frames, once, and sends their stripes to the
/// stripes' owners.
class FrameRounds {
 public:
  /// `memory`: bytes for the frames that a rank reads, sends and receives in a round. At least a frame is
  /// held.
  FrameRounds(Communicator& ranks, const Stripes& stripes, const SharedClip& clip, std::size_t memory);

  /// Reads at most `most` frames from frame `first` on, and puts this rank's stripes of them. Returns
  /// the number of frames, the same on all ranks; 0 at the clip's end. Throws FailedTogether.
  std::size_t next(std::size_t first, std::size_t most, const PutValues& put, const core::Context& context);

  [[nodiscard]] const core::ClipInfo& info() const { return clip_.info; }
  [[nodiscard]] std::size_t value_bytes() const { return value_bytes_; }
  [[nodiscard]] std::size_t decoded() const { return decoded_; }  ///< frames, by this rank

 private:
  [[nodiscard]] std::size_t asked_from(std::size_t first, std::size_t most) const;
  [[nodiscard]] std::vector<cv::Mat> read(std::size_t first, std::size_t last, const core::Context& context);
  [[nodiscard]] std::vector<std::byte> packed(const std::vector<cv::Mat>& frames) const;

  Communicator& ranks_;
  const Stripes& stripes_;
  SharedClip clip_;
  std::size_t value_bytes_, segment_, position_ = 0, decoded_ = 0;
  bool began_ = false;
};

}  // namespace emberfold::dytex
