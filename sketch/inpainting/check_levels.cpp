// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/check_levels.hpp"

#include <sstream>

#include <opencv2/core.hpp>

#include "core/error.hpp"

namespace emberfold::sketch {

void check_levels_and_mask(const char* caller, const cv::Mat& levels, const cv::Mat& mask) {
  std::ostringstream message;
  if (levels.dims != 2 || levels.empty() || levels.depth() != CV_32F ||
      (levels.channels() != 1 && levels.channels() != 3))
    message << caller << ": levels are " << cv::typeToString(levels.type()) << ", " << levels.cols << " × "
            << levels.rows << "; allowed are CV_32FC1 and CV_32FC3 of at least 1 × 1";
  else if (mask.dims != 2 || mask.type() != CV_8UC1 || mask.size() != levels.size())
    message << caller << ": the mask is " << cv::typeToString(mask.type()) << ", " << mask.cols << " × "
            << mask.rows << "; it has to be CV_8UC1 of the levels' size, " << levels.cols << " × "
            << levels.rows;
  if (!message.str().empty()) throw core::InputError(message.str());
}

}  // namespace emberfold::sketch
