// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>

#include "sketch/background/still_background.hpp"

// Frames in cells of kBackgroundCell px; the last ones may reach beyond the frame.
namespace emberfold::sketch {

inline cv::Size background_cells(cv::Size frame) {
  return {(frame.width + kBackgroundCell - 1) / kBackgroundCell,
          (frame.height + kBackgroundCell - 1) / kBackgroundCell};
}

/// Each cell's mean over its pixels, those beyond the frame as at its edge.
inline cv::Mat cell_means(const cv::Mat& values) {
  const cv::Size count = background_cells(values.size());
  cv::Mat whole, means;
  cv::copyMakeBorder(values, whole, 0, count.height * kBackgroundCell - values.rows, 0,
                     count.width * kBackgroundCell - values.cols, cv::BORDER_REPLICATE);
  cv::resize(whole, means, count, 0, 0, cv::INTER_AREA);
  return means;
}

}  // namespace emberfold::sketch
