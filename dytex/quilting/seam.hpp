// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/blocks.hpp"

/// Minimum-error seams (Efros & Freeman 2001, section 2.1). Inner header of quilting.
namespace emberfold::dytex::detail {

/// The path from the first row to the last, a column each, neighbours at most one apart, along which the sum
/// of `cost` (CV_64F) is least; of equals the one that is leftmost, looked at from the last row upwards.
std::vector<int> least_seam(const cv::Mat& cost);

/// The sum of the costs along a seam.
double seam_cost(const cv::Mat& cost, const std::vector<int>& seam);

/// Where a block's own pixels show: CV_8U of the block's size, 255 or 0. `error` (CV_64F, of the block's
/// size): what a pixel differs from what is there; only read in the block's strips. In each strip the pixels
/// on the seam and those on the block's side of it are the block's.
cv::Mat block_mask(const cv::Mat& error, const QuiltBlock& block);

}  // namespace emberfold::dytex::detail
