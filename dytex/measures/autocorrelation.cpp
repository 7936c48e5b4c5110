// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/autocorrelation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kStillVariance = 1e-6;  // levels² a pixel; a clip below it is still
constexpr int kMostLags = 256;           // frames; bounds the memory

}  // namespace

Autocorrelation::Autocorrelation(cv::Size size, int lags)
    : size_(size), lags_(lags), products_(Eigen::VectorXd::Zero(std::max(0, lags) + 1)) {
  core::check_range("autocorrelation: lags", lags, 1, kMostLags);
  if (size.width < 1 || size.height < 1)
    throw core::InputError("autocorrelation: a frame has at least 1x1 pixels");
}

void Autocorrelation::add(const cv::Mat& luma) {
  if (luma.type() != CV_32FC1 || luma.size() != size_)
    throw core::InputError("autocorrelation: a frame must be luma, one channel of 32-bit floats, " +
                           core::size_text(size_));
  if (frames_ == 0) {
    reference_ = luma.clone();
    sum_ = cv::Mat::zeros(size_, CV_64F);
  }
  const cv::Mat frame = luma - reference_;
  cv::accumulate(frame, sum_);
  products_(0) += frame.dot(frame);
  for (std::size_t i = 0; i < last_.size(); ++i)
    products_(static_cast<Eigen::Index>(last_.size() - i)) += frame.dot(last_[i]);
  if (first_.size() < static_cast<std::size_t>(lags_)) first_.push_back(frame);
  last_.push_back(frame);
  if (last_.size() > static_cast<std::size_t>(lags_)) last_.erase(last_.begin());
  ++frames_;
}

Eigen::VectorXd Autocorrelation::values() const {
  if (frames_ <= lags_)
    throw core::InputError("autocorrelation: " + std::to_string(frames_) + " frames are too few for " +
                           std::to_string(lags_) + " lags");
  // Σ (y(t) − μ)(y(t+τ) − μ) = Σ y(t) y(t+τ) − μ (Σ without the last τ + Σ without the first τ) + (T−τ) μ²
  const cv::Mat mean = sum_ / frames_;
  cv::Mat ends = 2 * sum_, edge;
  const double square = mean.dot(mean);
  Eigen::VectorXd covariance(lags_ + 1);
  for (int lag = 0; lag <= lags_; ++lag) {
    if (lag > 0) {
      first_[static_cast<std::size_t>(lag - 1)].convertTo(edge, CV_64F);
      ends -= edge;
      last_[last_.size() - static_cast<std::size_t>(lag)].convertTo(edge, CV_64F);
      ends -= edge;
    }
    const double pairs = frames_ - lag;
    covariance(lag) = (products_(lag) - mean.dot(ends) + pairs * square) / pairs;
  }
  if (covariance(0) <= kStillVariance * size_.area()) return Eigen::VectorXd::Ones(lags_);
  return covariance.tail(lags_) / covariance(0);
}

double autocorrelation_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                                const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (p.size() != q.size() || p.size() == 0)
    throw core::InputError("autocorrelation distance: there are " + std::to_string(p.size()) + " and " +
                           std::to_string(q.size()) + " lags; allowed is the same number, at least 1");
  return std::sqrt((p - q).squaredNorm() / static_cast<double>(p.size()));
}

}  // namespace emberfold::dytex
