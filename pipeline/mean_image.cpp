// SPDX-License-Identifier: Apache-2.0
#include "pipeline/mean_image.hpp"

#include <opencv2/core.hpp>

namespace emberfold::pipeline {

MeanImage mean_image(core::FrameSource& source, const core::Context& context) {
  MeanImage mean;
  cv::Mat sum;
  source.rewind();
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    cv::Mat levels;
    core::to_levels(frame, source.info()).convertTo(levels, CV_64F);
    sum = sum.empty() ? levels : cv::Mat(sum + levels);
    ++mean.frames;
  }
  if (mean.frames > 0) cv::Mat(sum / mean.frames).convertTo(mean.levels, CV_32F);
  return mean;
}

}  // namespace emberfold::pipeline
