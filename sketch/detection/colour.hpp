// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/math/luma.hpp"

namespace emberfold::sketch {

/// Weights of blue, green and red in luma, in single precision.
inline constexpr std::array<float, 3> kLumaAxis = {static_cast<float>(core::kLumaWeights[0]),
                                                   static_cast<float>(core::kLumaWeights[1]),
                                                   static_cast<float>(core::kLumaWeights[2])};
/// Weights of blue, green and red: luma, red − green, blue − yellow. The latter two are scaled so that white
/// noise is as strong in all.
inline constexpr std::array<std::array<float, 3>, 3> kColourAxes = {
    {kLumaAxis, {0, -0.4726F, 0.4726F}, {0.5457F, -0.27285F, -0.27285F}}};

/// Returns the weights of one channel of the scale space.
inline const std::array<float, 3>& colour_axis(int channel) {
  return kColourAxes[static_cast<std::size_t>(channel)];
}

/// Computes the frame along the two axes of colour. `levels`: CV_32FC3. Grey frames give 0 everywhere.
std::vector<cv::Mat1f> compute_opponent_colours(const cv::Mat& levels);

}  // namespace emberfold::sketch
