// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/blocks.hpp"

/// Minimum-error seams (Efros & Freeman 2001, section 2.1). Inner header of quilting.
namespace emberfold::dytex::detail {

/// Finds the path of least cost (CV_64F) from the first row to the last: a column each, at most one from its
/// neighbours. Of equals the leftmost, from the last row upwards.
std::vector<int> least_seam(const cv::Mat& cost);

/// Returns the sum of the costs along a seam.
double seam_cost(const cv::Mat& cost, const std::vector<int>& seam);

/// Returns the mask of a block's own pixels along its seams: CV_8U of its size, 255 or 0. `error` (CV_64F, of
/// its size): each pixel's difference from the earlier blocks; only read in the block's strips. In each strip
/// the pixels on the seam and those on the block's side of it are the block's.
cv::Mat block_mask(const cv::Mat& error, const QuiltBlock& block);

}  // namespace emberfold::dytex::detail
