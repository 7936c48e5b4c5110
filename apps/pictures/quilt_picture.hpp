// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/quilt_map.hpp"

namespace emberfold::apps {

/// Where each pixel of a quilt comes from, CV_8UC3: the hue tells the place across the source, the lightness
/// the place down; sources differ in how pale they are. Pieces copied as they are show as even slopes.
cv::Mat draw_quilt_map(const dytex::QuiltMap& map, std::span<const cv::Size> sources);

/// A frame (CV_8UC3), dimmed, and the seams on it.
cv::Mat draw_seams(const cv::Mat& frame, const dytex::QuiltMap& map);

}  // namespace emberfold::apps
