// SPDX-License-Identifier: Apache-2.0
#include "dytex/baselines/gaussian_texture.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using namespace emberfold::test;

namespace {

constexpr int kMiddle = kTextureReach;

/// Lags of exp(−|d| / length), times what Hann leaves of them, moved by `drift` px to the right; 0 beyond.
cv::Mat falling(double variance, double length, int drift = 0) {
  cv::Mat lags = cv::Mat::zeros(kTextureLags, kTextureLags, CV_32F);
  for (int y = 0; y < kTextureLags; ++y)
    for (int x = 0; x < kTextureLags; ++x) {
      const int dx = x - kMiddle - drift, dy = y - kMiddle;
      if (std::abs(dx) > kTextureReach) continue;
      const auto taper = [](int lag) {
        return (1 + std::cos(std::numbers::pi * lag / (kTextureReach + 1))) / 2;
      };
      lags.at<float>(y, x) =
          static_cast<float>(variance * taper(dx) * taper(dy) * std::exp(-std::hypot(dx, dy) / length));
    }
  return lags;
}

GaussianTexture drifting(double variance, double length, double kept, int drift) {
  return {falling(variance, length), falling(kept * variance, length, drift)};
}

/// The mean of a(p) b(p + d) over the frame, term by term.
double going_together(const cv::Mat& a, const cv::Mat& b, int dx, int dy) {
  double sum = 0, count = 0;
  for (int y = std::max(0, -dy); y < std::min(a.rows, a.rows - dy); ++y)
    for (int x = std::max(0, -dx); x < std::min(a.cols, a.cols - dx); ++x, ++count)
      sum += double{a.at<float>(y, x)} * double{b.at<float>(y + dy, x + dx)};
  return sum / count;
}

}  // namespace

TEST_CASE("Gaussian texture: frames go together as the texture says, and drift as it does") {
  const auto texture = drifting(4, 3, 0.8, 2);
  GaussianTextureFrames frames(texture, {150, 110}, 5);
  constexpr int kFrames = 200;
  double mean = 0;
  std::array<double, 4> within{}, ahead{};
  const std::array<std::pair<int, int>, 4> lags{{{0, 0}, {2, 0}, {0, 3}, {-4, 5}}};
  cv::Mat before = frames.next();
  for (int t = 1; t < kFrames; ++t) {
    const cv::Mat now = frames.next();
    REQUIRE(now.size() == cv::Size(150, 110));
    mean += cv::mean(now)[0] / kFrames;
    for (std::size_t i = 0; i < 4; ++i) {
      within[i] += going_together(now, now, lags[i].first, lags[i].second) / (kFrames - 1);
      ahead[i] += going_together(before, now, lags[i].first, lags[i].second) / (kFrames - 1);
    }
    before = now;
  }
  CHECK_THAT(mean, WithinAbs(0, 0.1));
  for (std::size_t i = 0; i < 4; ++i) {
    const auto [dx, dy] = lags[i];
    CAPTURE(dx, dy);
    CHECK_THAT(within[i], WithinAbs(double{texture.within.at<float>(kMiddle + dy, kMiddle + dx)}, 0.12));
    CHECK_THAT(ahead[i], WithinAbs(double{texture.ahead.at<float>(kMiddle + dy, kMiddle + dx)}, 0.12));
  }
}

TEST_CASE("Gaussian texture: at another speed frames are as strong and go so much farther, backwards too") {
  const auto texture = drifting(4, 3, 0.8, 1);
  const auto ahead = [&](double speed, int dx) {
    GaussianTextureFrames frames(texture, {150, 110}, 5, 0, speed);
    double together = 0, strength = 0;
    cv::Mat before = frames.next();
    for (int t = 0; t < 100; ++t) {
      const cv::Mat now = frames.next();
      together += going_together(before, now, dx, 0) / 100;
      strength += now.dot(now) / (150 * 110) / 100;
      before = now;
    }
    CHECK_THAT(strength, WithinAbs(4, 0.1));
    return together;
  };
  // At its peak the correlation is 0.8 to the power of the speed times the variance.
  CHECK_THAT(ahead(1, 1), WithinAbs(3.2, 0.1));
  CHECK_THAT(ahead(2, 2), WithinAbs(2.56, 0.1));
  CHECK_THAT(ahead(-1, -1), WithinAbs(3.2, 0.1));
  CHECK_THAT(ahead(-2, -2), WithinAbs(2.56, 0.1));
  CHECK(ahead(-1, 1) < 2.5);
}

TEST_CASE("Gaussian texture: the first frame is as strong as any") {
  const auto texture = drifting(9, 2, 0.9, 0);
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const cv::Mat first = GaussianTextureFrames(texture, {90, 70}, seed).next();
    sum += first.dot(first) / 6300 / 40;
  }
  CHECK_THAT(sum, WithinAbs(9, 0.5));
}

TEST_CASE("Gaussian texture: means are those of the pixels seen, lag by lag") {
  core::Rng rng(3);
  const cv::Size size(45, 38);
  cv::Mat now(size, CV_32F), next(size, CV_32F), seen_now(size, CV_8U), seen_next(size, CV_8U);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      now.at<float>(y, x) = static_cast<float>(rng.normal());
      next.at<float>(y, x) = static_cast<float>(rng.normal());
      seen_now.at<uchar>(y, x) = rng.uniform() < 0.7 ? 255 : 0;
      seen_next.at<uchar>(y, x) = rng.uniform() < 0.6 ? 255 : 0;
    }
  GaussianTextureLearner learner(size);
  learner.add(now, seen_now, next, seen_next);
  // Hidden pixels do not matter.
  now.setTo(1000, seen_now == 0);
  next.setTo(-500, seen_next == 0);
  GaussianTextureLearner hidden(size);
  hidden.add(now, seen_now, next, seen_next);
  const auto learned = learner.learned();
  CHECK(cv::norm(learned.within, hidden.learned().within, cv::NORM_INF) < 1e-6);
  CHECK(cv::norm(learned.ahead, hidden.learned().ahead, cv::NORM_INF) < 1e-6);
  for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-3, 7}, {20, -31}, {31, 31}}) {
    double within = 0, within_count = 0, ahead = 0, ahead_count = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const int v = y + dy, u = x + dx;
        if (u < 0 || u >= size.width || v < 0 || v >= size.height) continue;
        const auto add = [&](const cv::Mat& a, const cv::Mat& shown, const cv::Mat& b, const cv::Mat& also,
                             double& sum, double& count) {
          if (shown.at<uchar>(y, x) == 0 || also.at<uchar>(v, u) == 0) return;
          sum += double{a.at<float>(y, x)} * double{b.at<float>(v, u)}, ++count;
        };
        add(now, seen_now, now, seen_now, within, within_count);
        add(next, seen_next, next, seen_next, within, within_count);
        add(now, seen_now, next, seen_next, ahead, ahead_count);
      }
    const double taper =
        (1 + std::cos(std::numbers::pi * dx / 32)) / 2 * (1 + std::cos(std::numbers::pi * dy / 32)) / 2;
    CAPTURE(dx, dy);
    CHECK_THAT(double{learned.within.at<float>(kMiddle + dy, kMiddle + dx)},
               WithinAbs(taper * within / within_count, 1e-5));
    CHECK_THAT(double{learned.ahead.at<float>(kMiddle + dy, kMiddle + dx)},
               WithinAbs(taper * ahead / ahead_count, 1e-5));
  }
}

TEST_CASE("Gaussian texture: learned back from what it draws") {
  const auto texture = drifting(2, 4, 0.7, -1);
  GaussianTextureFrames frames(texture, {160, 120}, 8);
  GaussianTextureLearner learner({160, 120});
  const cv::Mat all(120, 160, CV_8U, cv::Scalar(255));
  cv::Mat before = frames.next();
  for (int t = 0; t < 60; ++t) {
    const cv::Mat now = frames.next();
    learner.add(before, all, now, all);
    before = now;
  }
  const auto learned = learner.learned();
  // The learned covariance is tapered to 0 once more.
  const auto taper = [](int lag) { return (1 + std::cos(std::numbers::pi * lag / (kTextureReach + 1))) / 2; };
  for (const auto& [dx, dy] : {std::pair{0, 0}, {3, 0}, {0, -4}, {6, 6}}) {
    CAPTURE(dx, dy);
    const auto at = [&, x = dx, y = dy](const cv::Mat& lags) {
      return double{lags.at<float>(kMiddle + y, kMiddle + x)};
    };
    CHECK_THAT(at(learned.within), WithinAbs(taper(dx) * taper(dy) * at(texture.within), 0.1));
    CHECK_THAT(at(learned.ahead), WithinAbs(taper(dx) * taper(dy) * at(texture.ahead), 0.1));
  }
}

TEST_CASE("Gaussian texture: nothing from nothing, and frames smaller than the lags") {
  const cv::Mat none = cv::Mat::zeros(kTextureLags, kTextureLags, CV_32F);
  GaussianTextureFrames still({none, none}, {20, 10}, 1);
  for (int t = 0; t < 3; ++t) CHECK(cv::norm(still.next(), cv::NORM_INF) == 0);
  GaussianTextureLearner blind({1, 1});
  const cv::Mat value(1, 1, CV_32F, cv::Scalar(7)), hidden = cv::Mat::zeros(1, 1, CV_8U);
  blind.add(value, hidden, value, hidden);
  CHECK(cv::norm(blind.learned().within, cv::NORM_INF) == 0);
  CHECK(cv::checkRange(GaussianTextureFrames(drifting(1, 3, 0.5, 0), {1, 1}, 1).next()));
}
