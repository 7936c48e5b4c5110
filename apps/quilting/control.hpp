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
  double slow = 0, fast = 1;    ///< rates of black and white
  double early = 0, late = 30;  ///< offsets of black and white, frames
  std::string fit = "exact";    ///< if a map has another size: exact rejects it, stretch, centre
  std::string between = "linear", ends = "clamp";
  double jitter = 0;  ///< frames

  [[nodiscard]] bool is_plain() const { return rate.empty() && offset.empty() && jitter == 0; }
};

/// Parses "a:b" as two numbers. Throws Misuse naming `option` for other texts.
void parse_pair(const std::string& option, const std::string& text, double& first, double& second);

/// Makes the control of an output of this size. Throws Misuse for an invalid request, core::InputError or
/// core::IoError where a file does not fit or cannot be read.
dytex::TimeControl make_control(const ControlRequest& request, cv::Size size, cv::Size block,
                                std::uint64_t seed);

}  // namespace emberfold::apps
