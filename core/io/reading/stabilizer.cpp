// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/stabilizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::io {

namespace {

constexpr int kCoarsest = 24;       // px: shorter side of the coarsest level
constexpr int kRounds = 30;         // of Gauss-Newton, at each level
constexpr double kSettled = 2e-3;   // px: a smaller step ends the rounds
constexpr double kMemory = 24;      // frames in the mean
constexpr double kTukey = 4.685;    // in SD: residuals beyond it have weight 0; 95 % efficient
constexpr int kTurnsFrom = 50;      // px: shorter side of a level from which rotation and zoom are fitted
constexpr double kLeastSeen = 0.1;  // minimum share of the pixels seen in both

using Steps = cv::Vec4d;  // x, y (px), scale − 1, angle

/// One level of the reference's pyramid.
struct Level {
  cv::Mat reference, gradient_x, gradient_y, weight;
};

cv::Mat halved(const cv::Mat& image) {
  cv::Mat smaller;
  cv::pyrDown(image, smaller);
  return smaller;
}

Level make_level(const cv::Mat& reference, const cv::Mat& weight) {
  Level level{reference, {}, {}, weight};
  const cv::Mat kernel = (cv::Mat_<float>(1, 3) << -0.5F, 0.F, 0.5F);
  cv::filter2D(reference, level.gradient_x, CV_32F, kernel);
  cv::filter2D(reference, level.gradient_y, CV_32F, kernel.t());
  return level;
}

core::CameraMotion scaled(core::CameraMotion motion, double factor) {
  motion.x *= factor, motion.y *= factor;
  return motion;
}

/// The motion that first undoes a step of the reference, then does `motion`.
core::CameraMotion after_step(const core::CameraMotion& motion, const Steps& step) {
  const double scale = 1 / (1 + step[2]), angle = -step[3];
  const double x = -scale * (std::cos(angle) * step[0] - std::sin(angle) * step[1]),
               y = -scale * (std::sin(angle) * step[0] + std::cos(angle) * step[1]);
  core::CameraMotion result;
  result.scale = motion.scale * scale, result.angle = motion.angle + angle;
  const double c = motion.scale * std::cos(motion.angle), s = motion.scale * std::sin(motion.angle);
  result.x = c * x - s * y + motion.x, result.y = s * x + c * y + motion.y;
  return result;
}

/// Returns the spread of the residuals: 1.48 times the median of their magnitudes.
double spread(const cv::Mat& difference, const cv::Mat& weight) {
  std::vector<float> amounts;
  for (int y = 0; y < difference.rows; ++y)
    for (int x = 0; x < difference.cols; ++x)
      if (weight.at<float>(y, x) > 0) amounts.push_back(std::abs(difference.at<float>(y, x)));
  if (amounts.empty()) return 1;
  const auto middle = amounts.begin() + static_cast<std::ptrdiff_t>(amounts.size() / 2);
  std::ranges::nth_element(amounts, middle);
  return std::max(0.01, 1.4826 * static_cast<double>(*middle));
}

/// The step of the reference that explains the difference best.
Steps best_step(const Level& level, const cv::Mat& difference, const cv::Mat& weight, double misfit,
                bool similarity) {
  const double limit = kTukey * misfit;
  const double middle_x = (level.reference.cols - 1) / 2., middle_y = (level.reference.rows - 1) / 2.;
  cv::Matx44d normal = cv::Matx44d::zeros();
  cv::Vec4d right = cv::Vec4d::all(0);
  const int unknowns = similarity ? 4 : 2;
  for (int y = 0; y < difference.rows; ++y)
    for (int x = 0; x < difference.cols; ++x) {
      const double residual = double{difference.at<float>(y, x)};
      double w = double{weight.at<float>(y, x)};
      if (w <= 0) continue;
      if (std::abs(residual) >= limit) continue;
      w *= std::pow(1 - residual * residual / (limit * limit), 2);
      const double gx = double{level.gradient_x.at<float>(y, x)},
                   gy = double{level.gradient_y.at<float>(y, x)};
      const double px = x - middle_x, py = y - middle_y;
      const cv::Vec4d row(gx, gy, gx * px + gy * py, gy * px - gx * py);
      for (int i = 0; i < unknowns; ++i) {
        right[i] += w * row[i] * residual;
        for (int j = 0; j < unknowns; ++j) normal(i, j) += w * row[i] * row[j];
      }
    }
  // A small term on the diagonal keeps parameters that the picture does not determine where they are.
  for (int i = 0; i < 4; ++i) normal(i, i) += i < unknowns ? 1e-6 * normal(i, i) + 1e-9 : 1;
  return normal.solve(right, cv::DECOMP_CHOLESKY);
}

/// Improves the motion at one level.
core::CameraMotion align(const Level& level, const cv::Mat& luma, core::CameraMotion motion,
                         bool similarity) {
  const cv::Size size = luma.size();
  const double reach = 0.5 * std::hypot(size.width, size.height);
  // The best fit of all rounds is kept: a round may diverge where little of the picture is still.
  core::CameraMotion best = motion;
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    const cv::Mat matrix = warp_matrix(motion, size);
    cv::Mat placed, seen;
    cv::warpAffine(luma, placed, matrix, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    cv::warpAffine(cv::Mat(size, CV_32F, cv::Scalar(1)), seen, matrix, size,
                   cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
    const cv::Mat weight = level.weight.mul(seen);
    if (cv::countNonZero(weight) < kLeastSeen * size.area()) break;
    const cv::Mat difference = placed - level.reference;
    const double misfit = spread(difference, weight);
    if (misfit < least) least = misfit, best = motion;
    const Steps step = best_step(level, difference, weight, misfit, similarity);
    if (!std::isfinite(cv::norm(step)) || std::abs(step[2]) > 0.2 || std::abs(step[3]) > 0.2) break;
    motion = after_step(motion, step);
    if (std::hypot(step[0], step[1]) + reach * (std::abs(step[2]) + std::abs(step[3])) < kSettled) break;
  }
  return best;
}

}  // namespace

cv::Mat warp_matrix(const core::CameraMotion& motion, cv::Size size) {
  const double c = motion.scale * std::cos(motion.angle), s = motion.scale * std::sin(motion.angle);
  const double x = (size.width - 1) / 2., y = (size.height - 1) / 2.;
  return (cv::Mat_<double>(2, 3) << c, -s, x - c * x + s * y + motion.x, s, c, y - s * x - c * y + motion.y);
}

core::CameraMotion Stabilizer::follow(const cv::Mat& luma, const cv::Mat& mask) {
  if (!mean_.empty()) {
    std::vector<cv::Mat> frames{luma}, references{mean_}, weights;
    cv::Mat weight;
    cv::Mat(weight_ > 0).convertTo(weight, CV_32F, 1 / 255.);
    weights.push_back(weight);
    while (std::min(frames.back().rows, frames.back().cols) >= 2 * kCoarsest) {
      frames.push_back(halved(frames.back()));
      references.push_back(halved(references.back()));
      cv::Mat smaller;
      cv::resize(weights.back(), smaller, frames.back().size(), 0, 0, cv::INTER_NEAREST);
      weights.push_back(smaller);
    }
    core::CameraMotion motion = scaled(last_, std::ldexp(1., -static_cast<int>(frames.size() - 1)));
    for (std::size_t i = frames.size(); i-- > 0;) {
      const bool turns = kind_ == Stabilize::similarity &&
                         (i == 0 || std::min(frames[i].rows, frames[i].cols) >= kTurnsFrom);
      motion = align(make_level(references[i], weights[i]), frames[i], motion, turns);
      if (i > 0) motion = scaled(motion, 2);
    }
    last_ = motion;
  }
  remember(luma, mask);
  return last_;
}

void Stabilizer::remember(const cv::Mat& luma, const cv::Mat& mask) {
  const cv::Size size = luma.size();
  const cv::Mat matrix = warp_matrix(last_, size);
  cv::Mat placed, seen, counts = mask.empty() ? cv::Mat(size, CV_8U, cv::Scalar(255)) : mask;
  cv::warpAffine(luma, placed, matrix, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  cv::warpAffine(counts, seen, matrix, size, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  if (mean_.empty()) mean_ = placed.clone(), weight_ = cv::Mat::zeros(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      float& weight = weight_.at<float>(y, x);
      float& mean = mean_.at<float>(y, x);
      const float value = placed.at<float>(y, x);
      if (seen.at<std::uint8_t>(y, x) == 0) continue;
      weight = std::min(weight + 1, static_cast<float>(kMemory));
      mean += (value - mean) / weight;
    }
}

}  // namespace emberfold::io
