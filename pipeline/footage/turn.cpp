// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/turn.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/math/smooth_step.hpp"
#include "dytex/measures/optical_flow.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kMostVectors = 1 << 15;
constexpr int kAlikeSide = 3;    // vectors: side of the window whose mean difference decides whether it moves
constexpr float kMostNoise = 3;  // grey levels: mean differences above twice this count as motion
constexpr int kTurnSide = 80;    // px: maximum side of the pictures that are compared
constexpr double kNearby = 3;    // px of those pictures: SD of the window of similarity
constexpr double kMiddle =
    0.3;  // cost of turning at the way's ends instead of its middle, relative to the mean difference
constexpr double kDuration = 3;  // moments that a place takes to turn

cv::Mat1f luma_of(const cv::Mat& frame) {
  cv::Mat grey = frame, levels;
  if (frame.channels() == 3) cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(levels, CV_32F);
  return levels;
}

/// Returns the luma of a frame of at most kMostVectors pixels.
cv::Mat1f small_luma(const cv::Mat& frame) {
  const double factor = std::min(1.0, std::sqrt(kMostVectors / (double(frame.cols) * frame.rows)));
  if (factor >= 1) return luma_of(frame);
  cv::Mat small;
  cv::resize(frame, small,
             {std::max(1, static_cast<int>(frame.cols * factor)),
              std::max(1, static_cast<int>(frame.rows * factor))},
             0, 0, cv::INTER_AREA);
  return luma_of(small);
}

/// Sets the motion to 0 where two frames of luma differ by no more than noise.
void still_where_alike(cv::Mat& motion, const cv::Mat1f& frame, const cv::Mat1f& next) {
  cv::Mat difference;
  cv::absdiff(frame, next, difference);
  cv::Mat1f alike;
  cv::blur(difference, alike, {kAlikeSide, kAlikeSide});
  std::vector<float> levels(alike.begin(), alike.end());
  const auto low = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 5);
  std::ranges::nth_element(levels, low);
  const float noise = std::min(kMostNoise, 1.5F * *low + 0.25F);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x)
      motion.at<cv::Vec2f>(y, x) *= std::clamp(alike(y, x) / noise - 1, 0.F, 1.F);
}

/// Returns the frame moved along a share of its motion.
cv::Mat moved(const cv::Mat& frame, const cv::Mat& motion, double share) {
  cv::Mat full, out;
  cv::resize(motion, full, frame.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat2f from(frame.size());
  for (int y = 0; y < from.rows; ++y)
    for (int x = 0; x < from.cols; ++x) {
      const auto& v = full.at<cv::Vec2f>(y, x);
      from(y, x) = {static_cast<float>(x - share * double{v[0]}),
                    static_cast<float>(y - share * double{v[1]})};
    }
  cv::remap(frame, out, from, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return out;
}

/// Returns the local difference of two frames at each place, grey levels, at most kTurnSide px a side.
cv::Mat1f local_difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference, grey, small, levels;
  cv::absdiff(a, b, difference);
  grey = luma_of(difference);
  const double factor = std::min(1.0, double(kTurnSide) / std::max(a.cols, a.rows));
  cv::resize(grey, small,
             {std::max(1, static_cast<int>(a.cols * factor)), std::max(1, static_cast<int>(a.rows * factor))},
             0, 0, cv::INTER_AREA);
  cv::GaussianBlur(small, levels, {}, kNearby);
  return levels;
}

}  // namespace

cv::Mat footage_motion(const cv::Mat& frame, const cv::Mat& next) {
  const auto before = small_luma(frame), after = small_luma(next);
  cv::Mat motion = dytex::optical_flow(before, after, kMostVectors);
  still_where_alike(motion, before, after);
  motion = motion.mul(cv::Scalar(double(frame.cols) / motion.cols, double(frame.rows) / motion.rows));
  return motion;
}

cv::Mat draw_between(const cv::Mat& a, const cv::Mat& b, double share) {
  cv::Mat mixed;
  cv::addWeighted(moved(a, footage_motion(a, b), share), 1 - share, moved(b, footage_motion(b, a), 1 - share),
                  share, 0, mixed);
  return mixed;
}

cv::Mat1f turning_places(const std::vector<cv::Mat>& footage, const PlayedMoment& moment) {
  cv::Mat1f best, least;
  const int from = moment.frame - moment.place, to = moment.other - moment.place;
  for (int d = 1 - moment.half; d < moment.half; ++d) {
    const int before = from + d, after = to + d;
    auto difference =
        local_difference(footage[static_cast<std::size_t>(before)], footage[static_cast<std::size_t>(after)]);
    const double aside = kMiddle * cv::mean(difference)[0] * std::abs(d) / moment.half;
    difference += aside;
    if (best.empty()) {
      best = cv::Mat1f(difference.size(), static_cast<float>(d));
      least = difference;
      continue;
    }
    best.setTo(static_cast<float>(d), difference < least);
    least = cv::min(least, difference);
  }
  cv::Mat1f smooth;
  cv::GaussianBlur(best, smooth, {}, kNearby);
  return smooth;
}

cv::Mat draw_turn(const std::vector<cv::Mat>& footage, const PlayedMoment& moment, const cv::Mat1f& places) {
  const auto& a = footage[static_cast<std::size_t>(moment.frame)];
  const auto& b = footage[static_cast<std::size_t>(moment.other)];
  const double share = core::smooth_step((moment.place + moment.half + 0.5) / (2 * moment.half));
  const cv::Mat from_a = moved(a, footage_motion(a, b), share);
  const cv::Mat from_b = moved(b, footage_motion(b, a), 1 - share);
  cv::Mat turning;
  cv::resize(places, turning, a.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out(a.size(), a.type());
  const int channels = a.channels();
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) {
      const double t = moment.place + 0.5 - double{turning.at<float>(y, x)};
      const double w = core::smooth_step(t / kDuration + 0.5);
      for (int c = 0; c < channels; ++c) {
        const int i = x * channels + c;
        out.ptr<std::uint8_t>(y)[i] = cv::saturate_cast<std::uint8_t>(
            (1 - w) * from_a.ptr<std::uint8_t>(y)[i] + w * from_b.ptr<std::uint8_t>(y)[i]);
      }
    }
  return out;
}

cv::Mat1f TurningPlaces::at(const std::vector<cv::Mat>& footage, const PlayedMoment& moment) {
  if (moment.half == 0) return {};
  const Turn turn = turn_of(moment);
  if (places_.empty() || turn != turn_) places_ = turning_places(footage, moment);
  turn_ = turn;
  return places_;
}

cv::Mat draw_moment(const std::vector<cv::Mat>& footage, const PlayedMoment& moment,
                    const cv::Mat1f& places) {
  return moment.half > 0 ? draw_turn(footage, moment, places)
                         : footage[static_cast<std::size_t>(moment.frame)];
}

}  // namespace emberfold::pipeline
