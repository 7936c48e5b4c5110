// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/types.hpp>

namespace emberfold::sketch {

constexpr double kBackgroundDistance = 12;  ///< px from all patches, beyond which the still background shows

constexpr float kStraightStep = 0.955F, kSlantedStep = 1.3693F;  ///< px, a step's length to a neighbour

/// Computes the distance of each pixel from what the mask shows, px; what is there in part counts as if it
/// were farther off. A chamfer of two passes (Borgefors 1986, as OpenCV's DIST_MASK_3). Arrays hold the
/// frame's pixels row by row; `opacity`, 0…1, may be null: all of it is there. O(pixels).
void distance_from_patches(cv::Size size, const std::uint8_t* mask, const float* opacity, float* distance);

}  // namespace emberfold::sketch
