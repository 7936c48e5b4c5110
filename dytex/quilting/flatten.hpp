// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"

namespace emberfold::dytex {

/// Removes uneven light from a frame: each pixel less the light there, plus the frame's mean, channel by
/// channel. The light is a guided filter's estimate (He, Sun & Tang 2013) over Gaussian surroundings of SD
/// `sigma` px, mirrored at the border: smooth where levels change as usual, and with a step where a large
/// object ends, so that none gets a halo. Light that falls off across a source makes a quilt look blocky. Of
/// the frame's own type, rounded and held between 0 and white. O(pixels).
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
