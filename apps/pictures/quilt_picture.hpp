// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/quilt_map.hpp"

namespace emberfold::apps {

/// Draws the source of each pixel of a quilt, CV_8UC3. Hue is the source's x, lightness its y, saturation the
/// clip. Pieces copied verbatim appear as smooth gradients.
cv::Mat draw_quilt_map(const dytex::QuiltMap& map, std::span<const cv::Size> sources);

/// Draws the seams on a dimmed frame (CV_8UC3).
cv::Mat draw_seams(const cv::Mat& frame, const dytex::QuiltMap& map);

}  // namespace emberfold::apps
