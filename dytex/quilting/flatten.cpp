// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/flatten.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kGuideShare = 0.25;     // SD of the guide, of sigma: finer structure is detail
constexpr double kLeastVariance = 1e-8;  // of white squared: a frame without any structure

// Wide means, taken on a smaller picture where that loses nothing.
class Surroundings {
 public:
  Surroundings(cv::Size frame, double sigma)
      : frame_(frame), sigma_(sigma), factor_(std::max(1.0, std::floor(sigma * kGuideShare / 2))) {}

  [[nodiscard]] cv::Mat reduced(const cv::Mat& levels) const {
    cv::Mat small;
    const cv::Size size(std::max(1, cvRound(frame_.width / factor_)),
                        std::max(1, cvRound(frame_.height / factor_)));
    cv::resize(levels, small, size, 0, 0, cv::INTER_AREA);
    return small;
  }
  [[nodiscard]] cv::Mat mean(const cv::Mat& small, double share = 1) const {
    cv::Mat wide;
    cv::GaussianBlur(small, wide, {}, share * sigma_ * small.cols / frame_.width,
                     share * sigma_ * small.rows / frame_.height, cv::BORDER_REFLECT);
    return wide;
  }
  [[nodiscard]] cv::Mat enlarged(const cv::Mat& small) const {
    cv::Mat whole;
    cv::resize(small, whole, frame_, 0, 0, cv::INTER_CUBIC);
    return whole;
  }

 private:
  cv::Size frame_;
  double sigma_, factor_;
};

double median(const cv::Mat1f& values) {
  std::vector<float> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  return double{*middle};
}

// Returns the light on one channel.
cv::Mat light(const cv::Mat& levels, double sigma, double white) {
  const Surroundings around(levels.size(), sigma);
  const cv::Mat small = around.reduced(levels), guide = around.mean(small, kGuideShare);
  const cv::Mat mean = around.mean(guide), level = around.mean(small);
  const cv::Mat variance = around.mean(guide.mul(guide)) - mean.mul(mean);
  const cv::Mat covariance = around.mean(guide.mul(small)) - mean.mul(level);
  const double usual = std::max(median(variance), kLeastVariance * white * white);
  const cv::Mat slope = covariance / (cv::max(variance, 0) + usual);
  const cv::Mat offset = level - slope.mul(mean);
  return around.enlarged(around.mean(slope).mul(guide) + around.mean(offset));
}

}  // namespace

cv::Mat flatten(const cv::Mat& frame, const core::ClipInfo& info, double sigma) {
  cv::Mat levels, result;
  frame.convertTo(levels, CV_32F);
  std::vector<cv::Mat> channels;
  cv::split(levels, channels);
  for (cv::Mat& channel : channels) channel += cv::mean(channel)[0] - light(channel, sigma, info.white);
  cv::merge(channels, levels);
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
