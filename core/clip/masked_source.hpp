// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"

namespace emberfold::core {

/// Mask of a source's frames. A source that has one also derives from this class.
class ClipKnowledge {
 public:
  virtual ~ClipKnowledge() = default;
  /// Returns where structure counts in the last frame read: CV_8U, 255 where it counts; empty: everywhere.
  [[nodiscard]] virtual cv::Mat mask() const = 0;
};

/// Returns the mask of the last frame read; empty where the source has none.
cv::Mat mask_of(const FrameSource& source);

/// Freezes the pixels outside the mask: each keeps the last value that it had inside, initially that of the
/// first frame. Changes nothing for a source without a mask.
class HeldOutside final : public FrameSource, public ClipKnowledge {
 public:
  explicit HeldOutside(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}
  [[nodiscard]] const ClipInfo& info() const override { return source_->info(); }
  [[nodiscard]] cv::Mat mask() const override { return mask_of(*source_); }
  cv::Mat next() override;
  void rewind() override;

 private:
  std::unique_ptr<FrameSource> source_;
  cv::Mat held_;
};

}  // namespace emberfold::core
