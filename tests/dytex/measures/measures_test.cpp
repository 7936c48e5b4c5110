// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "dytex/measures/autocorrelation.hpp"
#include "dytex/measures/flow_histograms.hpp"
#include "dytex/measures/lbp_top.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "dytex/measures/psnr.hpp"
#include "dytex/measures/sharpness_si_ti.hpp"
#include "dytex/measures/ssim.hpp"
#include "tests/dytex/baselines/made_waves.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using namespace emberfold::test;

namespace {

cv::Mat random_luma(cv::Size size, std::uint64_t seed) {
  return white_noise(size.width, size.height, 1, 40, seed).frames[0];
}

BinaryPatterns patterns_of(const core::Clip& clip) {
  BinaryPatterns patterns;
  for (const auto& frame : clip.frames) patterns.add(frame);
  return patterns;
}

// A step of height 100, smoothed by a Gaussian of SD s, at an angle.
cv::Mat smooth_step(double s, double angle, double height = 100) {
  cv::Mat frame(80, 80, CV_32F);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 80; ++x) {
      const double d = (x - 40.3) * std::cos(angle) + (y - 40.3) * std::sin(angle);
      frame.at<float>(y, x) = static_cast<float>(60 + height / 2 * (1 + std::erf(d / (s * std::sqrt(2.0)))));
    }
  return frame;
}

}  // namespace

TEST_CASE("the autocorrelation agrees with its definition written out") {
  const int frames = 23, lags = 5;
  const auto clip = waves(frames, 4);
  Autocorrelation gathered({64, 64}, lags);
  for (const auto& frame : clip.frames) gathered.add(frame);
  std::vector<double> c(lags + 1, 0.0);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const auto value = [&](int t) {
        return static_cast<double>(clip.frames[static_cast<std::size_t>(t)].at<float>(y, x));
      };
      double mean = 0;
      for (int t = 0; t < frames; ++t) mean += value(t) / frames;
      for (int lag = 0; lag <= lags; ++lag)
        for (int t = 0; t + lag < frames; ++t)
          c[static_cast<std::size_t>(lag)] += (value(t) - mean) * (value(t + lag) - mean) / (frames - lag);
    }
  const auto found = gathered.values();
  for (int lag = 1; lag <= lags; ++lag)
    CHECK_THAT(found(lag - 1), WithinAbs(c[static_cast<std::size_t>(lag)] / c[0], 1e-5));
}

TEST_CASE("an auto-regression has the autocorrelation that it should") {
  const double pole = 0.8;
  core::Rng rng(9);
  Autocorrelation gathered({40, 40}, 6);
  cv::Mat state(40, 40, CV_32F, cv::Scalar(0));
  for (int t = 0; t < 400; ++t) {
    for (auto& value : cv::Mat_<float>(state))
      value = static_cast<float>(pole * static_cast<double>(value) + rng.normal());
    if (t >= 40) gathered.add(100 + 10 * state);
  }
  const auto found = gathered.values();
  // the mean of 360 frames takes some (1 + 0.8)/(1 − 0.8)/360 of the variance
  for (int lag = 1; lag <= 6; ++lag) CHECK_THAT(found(lag - 1), WithinAbs(std::pow(pole, lag), 0.03));
  Autocorrelation still({4, 4}, 2);
  for (int t = 0; t < 5; ++t) still.add(cv::Mat(4, 4, CV_32F, cv::Scalar(90)));
  CHECK(still.values() == Eigen::VectorXd::Ones(2));
}

TEST_CASE("binary patterns are those that eight comparisons make") {
  core::Clip clip = empty_clip(3, 3);
  // The middle of the middle frame is 100; brighter neighbours: left, the frame after's middle, below.
  for (int t = 0; t < 3; ++t) clip.frames.emplace_back(3, 3, CV_32F, cv::Scalar(50));
  clip.frames[1].at<float>(1, 1) = 100;
  clip.frames[1].at<float>(1, 0) = 101;
  clip.frames[1].at<float>(2, 1) = 100;  // as bright
  clip.frames[2].at<float>(1, 1) = 200;
  const auto patterns = patterns_of(clip);
  const auto only = [&](Plane plane) {
    Eigen::Index code = 0;
    const auto shares = patterns.shares(plane);
    CHECK(shares.maxCoeff(&code) == 1);
    return static_cast<int>(code);
  };
  // Clockwise from above left (or before left, or before above): bit 7 left, bit 5 below, in space.
  CHECK(only(Plane::xy) == (1 << 7 | 1 << 5));
  CHECK(only(Plane::xt) == (1 << 7 | 1 << 5));  // left now, the frame after
  CHECK(only(Plane::yt) == (1 << 3 | 1 << 5));  // below now, the frame after
}

TEST_CASE("distances of patterns are 0 for equals and symmetric and at most 1") {
  const auto a = patterns_of(waves(20, 1)), b = patterns_of(white_noise(64, 64, 20, 30, 2));
  CHECK(chi_square_distance(a, a) == 0);
  CHECK_THAT(chi_square_distance(a, b), WithinRel(chi_square_distance(b, a), 1e-12));
  CHECK(chi_square_distance(a, b) > 0.1);
  CHECK(chi_square_distance(a, b) < 1);
  Eigen::VectorXd p(3), q(3);
  p << 0.5, 0.5, 0;
  q << 0, 0, 1;
  CHECK(chi_square_distance(p, q) == 1);
}

TEST_CASE("the distance of motions is how far motion must be changed") {
  const auto field = [](float x, float y) { return cv::Mat(10, 10, CV_32FC2, cv::Scalar(x, y)); };
  FlowHistograms right, left, fast;
  right.add(field(2, 0)), left.add(field(-2, 0)), fast.add(field(5, 0));
  CHECK(flow_distance(right, right) == 0);
  CHECK(flow_distance(right, left, FlowPart::x) == 4);
  CHECK(flow_distance(right, left, FlowPart::speed) == 0);
  CHECK(flow_distance(right, left) == 4);
  CHECK(flow_distance(right, fast) == 3);
  CHECK(flow_distance(fast, right) == 3);
  FlowHistograms half = right;
  half.add(field(2, 1));
  CHECK_THAT(flow_distance(right, half, FlowPart::y), WithinAbs(0.5, 1e-12));
  FlowHistograms wild;
  wild.add(field(1e9F, std::numeric_limits<float>::quiet_NaN()));
  CHECK_THROWS_AS(flow_distance(wild, right), core::InputError);
}

TEST_CASE("flows of the same components differ where their speeds do") {
  // Two vectors each: x is 2 and 0, y is 2 and 0, the speeds are 2 and 2, or √8 and 0.
  FlowHistograms apart, together;
  apart.add((cv::Mat2f(1, 2) << cv::Vec2f(2, 0), cv::Vec2f(0, 2)));
  together.add((cv::Mat2f(1, 2) << cv::Vec2f(2, 2), cv::Vec2f(0, 0)));
  CHECK(flow_distance(apart, together, FlowPart::x) == 0);
  CHECK(flow_distance(apart, together, FlowPart::y) == 0);
  CHECK_THAT(flow_distance(apart, together), WithinAbs(std::sqrt(2.0), 1.0 / 16));
}

TEST_CASE("optical flow of reduced frames is in pixels of the whole ones, along either axis") {
  cv::Mat1f wide(260, 360);
  for (int y = 0; y < wide.rows; ++y)
    for (int x = 0; x < wide.cols; ++x)
      wide(y, x) = static_cast<float>(120 + 50 * std::sin(x / 7.0) * std::cos(y / 9.0) +
                                      30 * std::sin((x + y) / 11.0));
  const auto moved = [&](int right, int down) {
    return wide(cv::Rect(20 - right, 20 - down, 320, 220)).clone();
  };
  for (const double vectors : {320 * 220 / 4.0, 320 * 220 / 16.0}) {
    const cv::Mat flow = optical_flow(moved(0, 0), moved(4, -2), vectors);
    CHECK(static_cast<double>(flow.total()) <= vectors);
    const cv::Scalar mean =
        cv::mean(flow(cv::Rect(flow.cols / 4, flow.rows / 4, flow.cols / 2, flow.rows / 2)));
    CAPTURE(vectors);
    CHECK_THAT(mean[0], WithinAbs(4, 0.3));
    CHECK_THAT(mean[1], WithinAbs(-2, 0.3));
  }
}

TEST_CASE("a smooth step has the sharpness of its blur whatever its contrast and direction") {
  for (const double s : {1.5, 2.0, 3.0})
    for (const double angle : {0.0, 0.4, std::numbers::pi / 2, 2.2})
      for (const double height : {30.0, 150.0}) {
        const auto found = crease_sharpness(smooth_step(s, angle, height));
        INFO("s " << s << ", angle " << angle << ", height " << height);
        REQUIRE(found.points >= 40);
        // Sobel smooths by some 2/3 px² across and 1/2 along
        const double expected = 1 / (std::sqrt(2 * std::numbers::pi) * std::sqrt(s * s + 0.6));
        CHECK_THAT(found.sharpness, WithinRel(expected, 0.08));
        CHECK_THAT(found.gradient, WithinRel(height * expected, 0.08));
      }
  CHECK(crease_sharpness(cv::Mat(20, 20, CV_32F, cv::Scalar(9))).points == 0);
  CHECK(crease_sharpness(cv::Mat(2, 2, CV_32F, cv::Scalar(9))).points == 0);
}

TEST_CASE("blur takes sharpness and seams add it") {
  const auto clip = waves(12, 3);
  double sharp = 0, soft = 0;
  for (const auto& frame : clip.frames) {
    cv::Mat blurred;
    cv::GaussianBlur(frame, blurred, {}, 2);
    sharp += crease_sharpness(frame).sharpness, soft += crease_sharpness(blurred).sharpness;
  }
  CHECK(soft < 0.9 * sharp);
}

TEST_CASE("structural similarity agrees with its definition at one window") {
  const auto a = random_luma({11, 11}, 1);
  cv::Mat b = 0.6 * a + 0.4 * random_luma({11, 11}, 2) + 5;
  std::vector<double> weight(11);
  double all = 0;
  for (int i = 0; i < 11; ++i) weight[static_cast<std::size_t>(i)] = std::exp(-(i - 5) * (i - 5) / 4.5);
  for (const double u : weight)
    for (const double v : weight) all += u * v;
  double m = 0, n = 0, aa = 0, bb = 0, ab = 0;
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 11; ++x) {
      const double w = weight[static_cast<std::size_t>(x)] * weight[static_cast<std::size_t>(y)] / all;
      const double p = static_cast<double>(a.at<float>(y, x)), q = static_cast<double>(b.at<float>(y, x));
      m += w * p, n += w * q, aa += w * p * p, bb += w * q * q, ab += w * p * q;
    }
  const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
  const double expected =
      (2 * m * n + c1) * (2 * (ab - m * n) + c2) / ((m * m + n * n + c1) * (aa - m * m + bb - n * n + c2));
  CHECK_THAT(structural_similarity(a, b), WithinAbs(expected, 1e-9));
  CHECK_THAT(structural_similarity(b, a), WithinAbs(expected, 1e-9));
  CHECK_THAT(structural_similarity(a, a), WithinAbs(1, 1e-12));
  const auto large = random_luma({60, 40}, 3);
  CHECK(structural_similarity(large, random_luma({60, 40}, 4)) < 0.1);
  const auto tiny = random_luma({2, 1}, 5);
  CHECK_THAT(structural_similarity(tiny, tiny), WithinAbs(1, 1e-12));
}

TEST_CASE("errors in decibels") {
  const cv::Mat a(4, 4, CV_32FC3, cv::Scalar(10, 20, 30)), b(4, 4, CV_32FC3, cv::Scalar(13, 20, 30));
  CHECK_THAT(mean_square_error(a, b), WithinAbs(3, 1e-12));
  CHECK_THAT(psnr(1), WithinAbs(48.1308, 1e-4));
  CHECK(psnr(0) == kMostPsnr);
  CHECK(psnr(1e-30) == kMostPsnr);
}

TEST_CASE("spatial and temporal information are P.910's") {
  // A ramp has one slope everywhere: Sobel's answer is 8 times that, and its deviation 0.
  cv::Mat ramp(20, 20, CV_32F);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) ramp.at<float>(y, x) = static_cast<float>(5 * x);
  CHECK_THAT(spatial_information(ramp), WithinAbs(0, 1e-3));
  // One bright pixel: Sobel gives √2·a four times, 2a four times, 0 elsewhere.
  cv::Mat point(12, 12, CV_32F, cv::Scalar(0));
  point.at<float>(6, 6) = 100;
  const double mean = 4 * (100 * std::sqrt(2.0) + 200) / 100, square = 4 * (20000.0 + 40000.0) / 100;
  CHECK_THAT(spatial_information(point), WithinRel(std::sqrt(square - mean * mean), 1e-5));
  CHECK_THAT(temporal_information(point, cv::Mat(12, 12, CV_32F, cv::Scalar(7))),
             WithinRel(100 * std::sqrt(143.0) / 144, 1e-5));
  CHECK(temporal_information(ramp, ramp) == 0);
}

TEST_CASE("the measures of frames refuse what they cannot measure") {
  const cv::Mat luma(6, 6, CV_32F, cv::Scalar(1)), wide(6, 7, CV_32F, cv::Scalar(1)), bytes(6, 6, CV_8U);
  CHECK_THROWS_AS(structural_similarity(luma, wide), core::InputError);
  CHECK_THROWS_AS(structural_similarity(bytes, bytes), core::InputError);
  CHECK_THROWS_AS(temporal_information(luma, wide), core::InputError);
  CHECK_THROWS_AS(spatial_information(bytes), core::InputError);
  CHECK_THROWS_AS(crease_sharpness(bytes), core::InputError);
  CHECK_THROWS_AS(mean_square_error(luma, wide), core::InputError);
  CHECK_THROWS_AS(mean_square_error(bytes, bytes), core::InputError);
  CHECK_THROWS_AS(Autocorrelation({4, 4}, 0), core::InputError);
  CHECK_THROWS_AS(Autocorrelation({0, 4}, 2), core::InputError);
  Autocorrelation few({6, 6}, 2);
  few.add(luma), few.add(luma);
  CHECK_THROWS_AS(few.values(), core::InputError);
  CHECK_THROWS_AS(few.add(wide), core::InputError);
  BinaryPatterns patterns;
  patterns.add(luma);
  CHECK_THROWS_AS(patterns.add(wide), core::InputError);
  CHECK_THROWS_AS(patterns.add(bytes), core::InputError);
  FlowHistograms flow;
  CHECK_THROWS_AS(flow.add(luma), core::InputError);
  CHECK_THROWS_AS(chi_square_distance(Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(3)), core::InputError);
}
