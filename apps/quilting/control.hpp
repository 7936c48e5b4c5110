// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/render.hpp"

namespace emberfold::apps {

/// The time control of a quilt as given on the command line.
struct ControlRequest {
  /// A number, a .npy file (height × width, or height × width × 2 with offsets), an image, gradient:right
  /// (left, down, up), depth:IMAGE, distance:IMAGE (of a mask); empty: 1 and 0.
  std::string rate, offset;
  std::string ends = "clamp";
  double jitter = 0;  ///< frames

  [[nodiscard]] bool is_plain() const { return rate.empty() && offset.empty() && jitter == 0; }
};

/// Makes the control of an output of this size. Throws Misuse for an invalid request, core::InputError or
/// core::IoError where a file does not fit or cannot be read.
dytex::TimeControl make_control(const ControlRequest& request, cv::Size size, cv::Size block,
                                std::uint64_t seed);

}  // namespace emberfold::apps
