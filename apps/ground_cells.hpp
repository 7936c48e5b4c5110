// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>

#include "apps/ground.hpp"

// Frames in cells of kGroundCell px; the last ones may reach beyond the frame.
namespace emberfold::apps {

inline cv::Size ground_cells(cv::Size frame) {
  return {(frame.width + kGroundCell - 1) / kGroundCell, (frame.height + kGroundCell - 1) / kGroundCell};
}

/// Each cell's mean over its pixels, those beyond the frame as at its edge.
inline cv::Mat over_cells(const cv::Mat& values) {
  const cv::Size count = ground_cells(values.size());
  cv::Mat whole, means;
  cv::copyMakeBorder(values, whole, 0, count.height * kGroundCell - values.rows, 0,
                     count.width * kGroundCell - values.cols, cv::BORDER_REPLICATE);
  cv::resize(whole, means, count, 0, 0, cv::INTER_AREA);
  return means;
}

}  // namespace emberfold::apps
