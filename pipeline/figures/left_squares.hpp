// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Returns the sum of squares that a plane, fitted where `counts` is not 0, leaves of the levels.
double left_by_plane(const cv::Mat1f& level, const cv::Mat1b& counts);

/// Returns the sum of squares that one level inside the label (0…1, soft edges) and one outside leave where
/// `counts` is not 0.
double left_by_figure(const cv::Mat1f& level, const cv::Mat1f& label, const cv::Mat1b& counts);

}  // namespace emberfold::pipeline
