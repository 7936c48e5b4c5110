// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/optical_flow.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace emberfold::dytex {

namespace {

// Parameters of Farnebäck's method: scale and number of the pyramid's levels, side of the window in px,
// rounds, side and SD of the neighbourhood in px.
constexpr double kPyramidScale = 0.5, kNeighbourhoodDeviation = 1.1;
constexpr int kLevels = 3, kWindow = 15, kRounds = 3, kNeighbourhood = 5;
constexpr int kLeastSide = 8;  // px: smaller frames have no flow

cv::Mat reduced_bytes(const cv::Mat& luma, cv::Size size) {
  cv::Mat out = luma, bytes;
  if (size != luma.size()) cv::resize(luma, out, size, 0, 0, cv::INTER_AREA);
  out.convertTo(bytes, CV_8U);
  return bytes;
}

}  // namespace

cv::Mat optical_flow(const cv::Mat& luma, const cv::Mat& next, double most_vectors) {
  // The time is proportional to the vectors.
  const double factor = std::min(1.0, std::sqrt(most_vectors / (double(luma.cols) * luma.rows)));
  const cv::Size size(std::max(1, static_cast<int>(luma.cols * factor)),
                      std::max(1, static_cast<int>(luma.rows * factor)));
  if (size.width < kLeastSide || size.height < kLeastSide) return cv::Mat::zeros(size, CV_32FC2);
  cv::Mat flow;
  // Among OpenCV's dense methods only this one gives the same result at any number of threads.
  cv::calcOpticalFlowFarneback(reduced_bytes(luma, size), reduced_bytes(next, size), flow, kPyramidScale,
                               kLevels, kWindow, kRounds, kNeighbourhood, kNeighbourhoodDeviation, 0);
  return size == luma.size()
             ? flow
             : cv::Mat(flow.mul(cv::Scalar(double(luma.cols) / size.width, double(luma.rows) / size.height)));
}

}  // namespace emberfold::dytex
