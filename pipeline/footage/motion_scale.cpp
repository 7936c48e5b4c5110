// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/motion_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/math/robust.hpp"
#include "core/parallel.hpp"
#include "pipeline/footage/turn.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kMoves = 6;          // grey levels: SD over time of a moving pixel
constexpr std::size_t kPlaces = 16;   // where the motion is measured
constexpr std::size_t kMostStep = 8;  // maximum frames between two that are compared
constexpr double kChange = 4;         // grey levels by which compared frames differ where pixels move
constexpr std::size_t kMoments = 32;  // frames sampled for the SD over time

/// Measures the error on frames far enough apart to differ by more than noise.
double between_error(const std::vector<cv::Mat>& footage, const cv::Mat1b& moves,
                     const core::Context& context) {
  const double levels = double(cv::countNonZero(moves)) * footage.front().channels();
  double error = 0;
  for (std::size_t step = 1; step <= kMostStep && 2 * step < footage.size(); step *= 2) {
    const std::size_t room = footage.size() - 2 * step, places = std::min(kPlaces, room);
    std::vector<double> errors(places), changes(places);
    core::parallel_for(places, context, [&](std::size_t i) {
      const std::size_t t = i * room / places;
      const cv::Mat between = draw_between(footage[t], footage[t + 2 * step], 0.5);
      errors[i] = cv::norm(between, footage[t + step], cv::NORM_L1, moves);
      changes[i] = cv::norm(footage[t], footage[t + step], cv::NORM_L1, moves);
    });
    const double change = core::median(changes);
    error = change > 0 ? core::median(errors) / change : 0;
    if (change > kChange * levels) break;
  }
  return error;
}

}  // namespace

cv::Mat1b moving_pixels(const std::vector<cv::Mat>& footage) {
  cv::Mat sum, squares, levels;
  const std::size_t step = std::max<std::size_t>(1, footage.size() / kMoments);
  int used = 0;
  for (std::size_t t = 0; t < footage.size(); t += step, ++used) {
    footage[t].convertTo(levels, CV_32F);
    if (sum.empty()) {
      sum = cv::Mat::zeros(levels.size(), levels.type());
      squares = sum.clone();
    }
    sum += levels;
    squares += levels.mul(levels);
  }
  const cv::Mat mean = sum / used;
  cv::Mat variance = squares / used - mean.mul(mean);
  if (variance.channels() == 3) {
    cv::Mat grey;
    cv::transform(variance, grey, cv::Matx13f(1 / 3.F, 1 / 3.F, 1 / 3.F));
    variance = grey;
  }
  cv::Mat1b moves;
  cv::compare(variance, kMoves * kMoves, moves, cv::CMP_GT);
  return moves;
}

MotionScale measure_motion_scale(const std::vector<cv::Mat>& footage, const core::Context& context) {
  MotionScale scale{moving_pixels(footage)};
  if (cv::countNonZero(scale.moves) == 0) return scale;
  const std::size_t places = std::min(kPlaces, footage.size() - 1);
  std::vector<std::vector<float>> speeds(places);
  core::parallel_for(places, context, [&](std::size_t i) {
    const std::size_t t = i * (footage.size() - 1) / places;
    const cv::Mat motion = footage_motion(footage[t], footage[t + 1]);
    cv::Mat1b where;
    cv::resize(scale.moves, where, motion.size(), 0, 0, cv::INTER_NEAREST);
    for (int y = 0; y < motion.rows; ++y)
      for (int x = 0; x < motion.cols; ++x)
        if (where(y, x) != 0) speeds[i].push_back(static_cast<float>(cv::norm(motion.at<cv::Vec2f>(y, x))));
  });
  std::vector<float> all;
  for (const auto& some : speeds) all.insert(all.end(), some.begin(), some.end());
  if (all.empty()) return scale;
  const auto at = all.begin() + static_cast<std::ptrdiff_t>(all.size() * 3 / 4);
  std::ranges::nth_element(all, at);
  scale.speed = double{*at};
  scale.between_error = between_error(footage, scale.moves, context);
  return scale;
}

}  // namespace emberfold::pipeline
