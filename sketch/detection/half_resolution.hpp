// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds how a frame of half the width and height, whose pixels are twice as large, lies in the frame. Along
/// an even side a pixel is the mean of two, along an odd one it is every second: a mirrored frame is
/// mirrored.
class HalfResolution {
 public:
  explicit HalfResolution(cv::Size frame);

  /// Returns the part of the halved frame for a part of the frame.
  [[nodiscard]] static FramePart halved(const FramePart& part);

  /// Halves luma's levels; those of other channels keep their scale alone. Their noise is that of derivatives
  /// by the larger pixels. O(pixels · levels).
  [[nodiscard]] ScaleSpace halved(const ScaleSpace& space) const;

  /// Returns a point of the frame in the halved one. Its evidence and contrast stay.
  [[nodiscard]] CreasePoint halved(const CreasePoint& point) const;

  /// Returns a curve of the halved frame in the frame, with points midway between its points: about one a
  /// pixel again.
  [[nodiscard]] Chain to_frame(const Chain& chain) const;

 private:
  int right_, below_;   // px from a pixel's first in the frame to its last
  graph::Point first_;  // middle of the halved frame's first pixel
};

}  // namespace emberfold::sketch
