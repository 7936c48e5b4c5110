// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"

namespace emberfold::io {

/// Reads a mask that may be partly transparent from an image: CV_8U or CV_16U, one channel (luma of a
/// coloured one), white inside. Where no value is above a quarter of white, as in images of labels, all but 0
/// become white. Throws core::IoError where it cannot be read.
cv::Mat read_mask(const std::string& path);

/// Reads from an image where a mask counts: CV_8U, 255 where it does, 0 elsewhere (MaskSource). Throws
/// core::IoError where it cannot be read.
cv::Mat read_inside(const std::string& path);

/// Returns whether the file's compression (JPEG, videos) may change a 0 into small values.
bool is_lossy_mask(const std::string& path);

/// Returns where the values of a mask count, CV_8U, one channel: 255 where they are finite and not 0, so that
/// masks of 0 and 1, of 0 and 255, and of labels work alike. In lossy masks a pixel counts above half of the
/// brightest value so far, unless that value is small enough to be a label.
class MaskSource final : public core::FrameSource {
 public:
  /// `values`: one channel. `is_lossy`: values may differ a little from those intended.
  MaskSource(std::unique_ptr<core::FrameSource> values, bool is_lossy);
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  cv::Mat next() override;
  void rewind() override;

 private:
  std::unique_ptr<core::FrameSource> values_;
  core::ClipInfo info_;
  bool is_lossy_;
  double brightest_ = 0;  ///< so far
};

}  // namespace emberfold::io
