// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/flatten.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"

namespace emberfold::dytex {

namespace {

// A wide Gaussian, taken on a smaller picture where it is so wide that nothing is lost by that.
cv::Mat blurred(const cv::Mat& levels, double sigma) {
  const double factor = std::max(1.0, std::floor(sigma / 4));
  cv::Mat small, wide;
  const cv::Size size(std::max(1, cvRound(levels.cols / factor)), std::max(1, cvRound(levels.rows / factor)));
  cv::resize(levels, small, size, 0, 0, cv::INTER_AREA);
  const double across = sigma * size.width / levels.cols, down = sigma * size.height / levels.rows;
  cv::GaussianBlur(small, small, {}, across, down, cv::BORDER_REFLECT);
  cv::resize(small, wide, levels.size(), 0, 0, cv::INTER_CUBIC);
  return wide;
}

}  // namespace

cv::Mat flatten(const cv::Mat& frame, const core::ClipInfo& info, double sigma) {
  cv::Mat levels, result;
  frame.convertTo(levels, CV_32F);
  levels = levels - blurred(levels, sigma) + cv::mean(levels);
  if (info.depth != CV_32F) {
    cv::min(levels, cv::Scalar::all(info.white), levels);
    cv::max(levels, cv::Scalar::all(0), levels);
  }
  levels.convertTo(result, frame.depth());
  return result;
}

FlattenedSource::FlattenedSource(core::FrameSource& source, double sigma) : source_(source), sigma_(sigma) {
  if (sigma >= 1 && sigma <= 4096) return;
  std::ostringstream line;
  line << "the SD of what is flattened is " << sigma << "; allowed is 1 to 4096 pixels";
  throw core::InputError(line.str());
}

cv::Mat FlattenedSource::next() {
  const cv::Mat frame = source_.next();
  return frame.empty() ? frame : flatten(frame, source_.info(), sigma_);
}

}  // namespace emberfold::dytex
