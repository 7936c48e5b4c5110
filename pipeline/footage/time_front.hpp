// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// A smooth random field over space and time: by how many frames each place runs before or behind the others
/// (time fronts, Rav-Acha et al. 2007). A sum of plane waves of random direction, stationary, of mean 0.
class TimeFront {
 public:
  /// `amplitude`: SD, frames. `range`: px, over which the field is smooth. `rate`: SD of the share by which
  /// local time runs faster or slower. `loop`: the field repeats after so many frames.
  TimeFront(double amplitude, double range, double rate, std::uint64_t seed, std::optional<int> loop = {});

  /// Returns the offsets at frame n, frames, CV_32F, |offset| ≤ `most` ≤ bound(), in that proportion.
  /// O(pixels).
  [[nodiscard]] cv::Mat1f at(double n, cv::Size size, double most) const;
  /// Greatest offset, frames: 3 SD.
  [[nodiscard]] double bound() const { return 3 * amplitude_; }

 private:
  struct Wave {
    double x, y, t, phase;  // rad a px, rad a px, rad a frame, rad
  };
  double amplitude_;
  std::vector<Wave> waves_;
};

}  // namespace emberfold::pipeline
