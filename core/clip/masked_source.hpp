// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"

namespace emberfold::core {

/// Motion of a picture relative to the clip's first one: a point p of the first, from the middle of the
/// frame, appears at scale · R(angle) p + (x, y).
struct CameraMotion {
  double x = 0, y = 0;  ///< px of the stored frames
  double scale = 1;
  double angle = 0;  ///< radians, from x to y
};

/// Mask and camera motion of a source's frames. A source that has them also derives from this class.
class ClipKnowledge {
 public:
  virtual ~ClipKnowledge() = default;
  /// Returns where structure counts in the last frame read: CV_8U, 255 where it counts; empty: everywhere.
  [[nodiscard]] virtual cv::Mat mask() const = 0;
  /// Returns the motion removed from each frame so far; empty where none was to be removed.
  [[nodiscard]] virtual std::vector<CameraMotion> drift() const = 0;
};

/// Returns the mask of the last frame read; empty where the source has none.
cv::Mat mask_of(const FrameSource& source);
/// Returns the motion removed from the frames read so far; empty where the source removed none.
std::vector<CameraMotion> drift_of(const FrameSource& source);

/// Freezes the pixels outside the mask: each keeps the last value that it had inside, initially that of the
/// first frame. Changes nothing for a source without a mask.
class HeldOutside final : public FrameSource, public ClipKnowledge {
 public:
  explicit HeldOutside(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}
  [[nodiscard]] const ClipInfo& info() const override { return source_->info(); }
  [[nodiscard]] cv::Mat mask() const override { return mask_of(*source_); }
  [[nodiscard]] std::vector<CameraMotion> drift() const override { return drift_of(*source_); }
  cv::Mat next() override;
  void rewind() override;

 private:
  std::unique_ptr<FrameSource> source_;
  cv::Mat held_;
};

}  // namespace emberfold::core
