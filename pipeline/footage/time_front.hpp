// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// A smooth random field over space and time: the frames by which each place runs ahead of or behind the
/// others (time fronts, Rav-Acha et al. 2007). A sum of plane waves of random direction; stationary, mean 0.
class TimeFront {
 public:
  /// `amplitude`: SD, frames. `range`: px, over which the field is smooth. `rate`: SD of the relative speed
  /// of local time. `loop`: frames after which the field repeats.
  TimeFront(double amplitude, double range, double rate, std::uint64_t seed, std::optional<int> loop = {});

  /// Returns the offsets at frame n, frames, CV_32F, scaled from ±bound() to |offset| ≤ `most` ≤ bound().
  /// O(pixels).
  [[nodiscard]] cv::Mat1f at(double n, cv::Size size, double most) const;
  /// Returns the greatest offset, frames: 3 SD.
  [[nodiscard]] double bound() const { return 3 * amplitude_; }

 private:
  struct Wave {
    double x, y, t, phase;  // rad per px, rad per px, rad per frame, rad
  };
  double amplitude_;
  std::vector<Wave> waves_;
};

}  // namespace emberfold::pipeline
