// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"

namespace emberfold::core {

/// Where a picture stands against the clip's first one: a point p of the first, from the middle of the frame,
/// is seen at scale · R(angle) p + (x, y).
struct CameraMotion {
  double x = 0, y = 0;  ///< px of the frames as they are stored
  double scale = 1;
  double angle = 0;  ///< radians, from x to y
};

/// What a source knows about its frames beside their pixels. A source that knows it is derived from this,
/// too.
class ClipKnowledge {
 public:
  virtual ~ClipKnowledge() = default;
  /// Returns where structure counts in the frame that was read last: CV_8U, 255 there; empty: everywhere.
  [[nodiscard]] virtual cv::Mat mask() const = 0;
  /// Returns the motion that was taken out of each frame so far; empty where none was to be.
  [[nodiscard]] virtual std::vector<CameraMotion> drift() const = 0;
};

/// Returns the mask of the frame that was read last; empty where the source knows of none.
cv::Mat mask_of(const FrameSource& source);
/// Returns the motion that was taken out of the frames that were read; empty where the source took out none.
std::vector<CameraMotion> drift_of(const FrameSource& source);

/// Lets the pixels outside the mask stand still: each keeps the value that it had inside last, at first that
/// of the first frame. Changes nothing for a source without a mask.
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
