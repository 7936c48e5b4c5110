// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/seam.hpp"

#include <algorithm>

#include <opencv2/core.hpp>

namespace emberfold::dytex::detail {

std::vector<int> least_seam(const cv::Mat& cost) {
  cv::Mat sum = cost.clone();
  const int columns = cost.cols;
  // Returns the best previous column: the least of up to three, the leftmost of equals.
  const auto before = [&](int y, int x) {
    const auto* row = sum.ptr<double>(y - 1);
    const int first = std::max(0, x - 1), last = std::min(columns - 1, x + 1);
    return static_cast<int>(std::min_element(row + first, row + last + 1) - row);
  };
  for (int y = 1; y < sum.rows; ++y)
    for (int x = 0; x < columns; ++x) sum.at<double>(y, x) += sum.at<double>(y - 1, before(y, x));
  std::vector<int> seam(static_cast<std::size_t>(sum.rows));
  const auto* last = sum.ptr<double>(sum.rows - 1);
  seam.back() = static_cast<int>(std::min_element(last, last + columns) - last);
  for (int y = sum.rows - 1; y > 0; --y)
    seam[static_cast<std::size_t>(y - 1)] = before(y, seam[static_cast<std::size_t>(y)]);
  return seam;
}

double seam_cost(const cv::Mat& cost, const std::vector<int>& seam) {
  double total = 0;
  for (int y = 0; y < cost.rows; ++y) total += cost.at<double>(y, seam[static_cast<std::size_t>(y)]);
  return total;
}

namespace {

// Hides the outer side of the seam in a strip along the left side.
void cut_left(const cv::Mat& error, cv::Mat mask, int width) {
  const auto seam = least_seam(error.colRange(0, width));
  for (int y = 0; y < mask.rows; ++y) mask.row(y).colRange(0, seam[static_cast<std::size_t>(y)]).setTo(0);
}

cv::Mat turn_picture(const cv::Mat& picture, bool swap, bool mirror) {
  cv::Mat result = picture.clone();
  if (swap) cv::transpose(picture, result);
  if (mirror) cv::flip(result.clone(), result, 1);
  return result;
}

// Cuts along any side, after turning the block so that it becomes the left one.
void cut_side(const cv::Mat& error, cv::Mat& mask, int width, bool swap, bool mirror) {
  if (width == 0) return;
  cv::Mat side =
      cv::Mat(swap ? error.cols : error.rows, swap ? error.rows : error.cols, CV_8U, cv::Scalar(255));
  cut_left(turn_picture(error, swap, mirror), side, width);
  if (mirror) cv::flip(side.clone(), side, 1);
  if (swap) cv::transpose(side.clone(), side);
  cv::bitwise_and(mask, side, mask);
}

}  // namespace

cv::Mat block_mask(const cv::Mat& error, const QuiltBlock& block) {
  cv::Mat mask(error.size(), CV_8U, cv::Scalar(255));
  cut_side(error, mask, block.left, false, false);
  cut_side(error, mask, block.top, true, false);
  cut_side(error, mask, block.right, false, true);
  cut_side(error, mask, block.bottom, true, true);
  return mask;
}

}  // namespace emberfold::dytex::detail
