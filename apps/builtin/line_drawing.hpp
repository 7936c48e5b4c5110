// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A point of a line with contrast and width.
struct Dab {
  cv::Point2d at;
  double contrast = 0;  ///< grey levels, ≥ 0
  double sigma = 1;     ///< px
};

/// Draws a line with a Gaussian profile into a field (CV_32F) as the maximum with its content, so that lines
/// that meet do not add up.
void draw_line(cv::Mat& field, const std::vector<Dab>& dabs);

}  // namespace emberfold::apps
