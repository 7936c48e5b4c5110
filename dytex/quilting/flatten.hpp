// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"

namespace emberfold::dytex {

/// Takes the low frequencies in space out of a frame: each pixel less the mean of its surroundings (a
/// Gaussian of SD `sigma` px, the frame mirrored at its border), plus the frame's mean. Light that falls off
/// across a source makes a quilt look blocky. Of the frame's own type, rounded and held between 0 and white.
cv::Mat flatten(const cv::Mat& frame, const core::ClipInfo& info, double sigma);

/// A source whose frames are flattened; `source` must outlive it.
class FlattenedSource final : public core::FrameSource {
 public:
  /// InputError unless sigma is 1 … 4096 px.
  FlattenedSource(core::FrameSource& source, double sigma);
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override;
  void rewind() override { source_.rewind(); }

 private:
  core::FrameSource& source_;
  double sigma_;
};

}  // namespace emberfold::dytex
