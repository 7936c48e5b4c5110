// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/copied_share.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include <opencv2/core.hpp>

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kCopiedPixels = 4096;
constexpr int kSameLevel = 2;  // grey levels: difference due to JPEG or to interpolation of still pixels

/// Counts pixels (`channels` bytes each, in one row) whose levels agree in all channels.
int count_same(const cv::Mat& a, const cv::Mat& b) {
  const int channels = a.channels();
  const auto *x = a.ptr<std::uint8_t>(), *y = b.ptr<std::uint8_t>();
  int count = 0;
  for (int i = 0; i < a.cols; ++i, x += channels, y += channels) {
    int most = 0;
    for (int c = 0; c < channels; ++c) most = std::max(most, std::abs(int{x[c]} - int{y[c]}));
    count += most <= kSameLevel ? 1 : 0;
  }
  return count;
}

}  // namespace

CopiedShare::CopiedShare(const std::vector<cv::Mat>& footage, const cv::Mat1b& moves) {
  std::vector<cv::Point> moving;
  cv::findNonZero(moves, moving);
  const std::size_t stride = moving.size() / kCopiedPixels + 1;
  for (std::size_t i = 0; i < moving.size(); i += stride) pixels_.push_back(moving[i]);
  for (const auto& frame : footage) footage_.push_back(picked(frame));
}

cv::Mat CopiedShare::picked(const cv::Mat& frame) const {
  cv::Mat row(1, static_cast<int>(pixels_.size()), frame.type());
  const std::size_t bytes = frame.elemSize();
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    std::copy_n(frame.ptr(pixels_[i].y, pixels_[i].x), bytes, row.ptr() + i * bytes);
  return row;
}

void CopiedShare::add(const cv::Mat& frame) {
  if (pixels_.empty()) return;
  const cv::Mat row = picked(frame);
  int most = 0;
  for (const auto& one : footage_) most = std::max(most, count_same(row, one));
  sum_ += double(most) / double(pixels_.size());
  ++frames_;
}

}  // namespace emberfold::pipeline
