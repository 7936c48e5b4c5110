// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// The hidden pixels of a clip: a bit for every pixel and frame. All channels of a pixel are hidden together.
/// Without frames nothing is hidden.
class Missing {
 public:
  Missing() = default;
  /// Reads a mask: pixels at least half as bright as white (luma) are hidden. `clip`: the clip it belongs to.
  /// Throws InputError where its size differs, it has no frames, or hides every pixel of all frames but one.
  Missing(core::FrameSource& mask, const core::ClipInfo& clip, const core::Context& context = {});

  [[nodiscard]] bool any() const { return frames_ > 0; }
  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t pixels() const { return pixels_; }
  /// Throws InputError unless the mask has this number of frames, or none.
  void check_frames(std::size_t frames) const;

  [[nodiscard]] bool hidden(std::size_t pixel, std::size_t frame) const {
    return frames_ > 0 && (pattern(pixel)[frame / 64] >> (frame % 64) & 1) != 0;
  }
  /// Returns the number of hidden pixels of a frame.
  [[nodiscard]] std::size_t count(std::size_t frame) const { return frames_ > 0 ? counts_[frame] : 0; }
  [[nodiscard]] bool all_seen(std::size_t frame) const { return count(frame) == 0; }
  [[nodiscard]] bool all_hidden(std::size_t frame) const { return frames_ > 0 && counts_[frame] == pixels_; }
  /// Returns whether each frame is either all seen or all hidden.
  [[nodiscard]] bool by_frames() const;
  /// Returns a pixel's bits, frame 0 the lowest of the first word.
  [[nodiscard]] std::span<const std::uint64_t> pattern(std::size_t pixel) const {
    return {bits_.data() + pixel * words_, words_};
  }
  /// Returns τ numbers: equal where adjacent frames hide the same pixels; −1 where all are hidden.
  [[nodiscard]] const std::vector<int>& groups() const { return groups_; }

 private:
  void add_frame(const cv::Mat& luma, double threshold);

  std::size_t pixels_ = 0, frames_ = 0, words_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::size_t> counts_;
  std::vector<int> groups_;
  cv::Mat before_;  // the frame before, while reading
};

/// A clip with its hidden values filled in from a texture that was learned from it: mean + C x(t), x(t) the
/// texture's states. Of the clip's depth and range; rounded for whole numbers.
/// `source`, `missing` and `texture` must outlive it.
class FilledSource final : public core::FrameSource {
 public:
  /// InputError where sizes or numbers of frames disagree.
  FilledSource(core::FrameSource& source, const Missing& missing, const LinearDynamicTexture& texture);
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override;
  void rewind() override;

 private:
  core::FrameSource& source_;
  const Missing& missing_;
  const LinearDynamicTexture& texture_;
  std::size_t position_ = 0;
};

/// A clip whose hidden pixels hold their last seen value; before that, the mean of the seen ones. A pixel
/// that is never seen has the mean of all pixels. Reads the source once when constructed.
class HeldSource final : public core::FrameSource {
 public:
  HeldSource(core::FrameSource& source, const Missing& missing, const core::Context& context);
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override;
  void rewind() override;
  [[nodiscard]] std::size_t never_seen() const { return never_seen_; }  ///< pixels

 private:
  core::FrameSource& source_;
  const Missing& missing_;
  cv::Mat mean_, held_;
  std::size_t position_ = 0, never_seen_ = 0;
};

}  // namespace emberfold::dytex
