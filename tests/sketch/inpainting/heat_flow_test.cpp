// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/heat_flow.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "sketch/inpainting/fill.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

cv::Mat random_levels(cv::Size size, int channels, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat levels(size, CV_32FC(channels));
  for (int y = 0; y < size.height; ++y)
    for (int i = 0; i < size.width * channels; ++i)
      levels.ptr<float>(y)[i] = static_cast<float>(rng.uniform(0, 255));
  return levels;
}

cv::Mat some_held(cv::Size size, double share, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat mask(size, CV_8U, cv::Scalar(0));
  for (uchar& value : cv::Mat_<uchar>(mask)) value = rng.uniform() < share ? 1 : 0;
  mask.at<uchar>(size.height / 2, size.width / 2) = 1;
  return mask;
}

}  // namespace

TEST_CASE("One step of heat is the 5-point formula", "[sketch][heat]") {
  const cv::Size size(13, 9);
  const cv::Mat levels = random_levels(size, 3, 1), mask = some_held(size, 0.3, 2);
  sketch::HeatFlow flow(levels, mask, 0.2);
  flow.advance(1);
  const cv::Mat after = flow.levels();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const double own = double(levels.at<cv::Vec3f>(y, x)[c]);
        double flowing = 0;
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
          if (x + dx >= 0 && y + dy >= 0 && x + dx < size.width && y + dy < size.height)
            flowing += double(levels.at<cv::Vec3f>(y + dy, x + dx)[c]) - own;
        const double expected = mask.at<uchar>(y, x) != 0 ? own : own + 0.2 * flowing;
        CHECK_THAT(double(after.at<cv::Vec3f>(y, x)[c]), WithinAbs(expected, 1e-3));
      }
  CHECK(flow.steps() == 1);
  CHECK_THAT(flow.time(), WithinAbs(0.2, 1e-12));
}

TEST_CASE("Heat ends as the fill", "[sketch][heat]") {
  for (const int channels : {1, 3})
    for (const double share : {0.005, 0.1}) {
      const cv::Size size(41, 30);
      const cv::Mat levels = random_levels(size, channels, 3), mask = some_held(size, share, 4);
      sketch::HeatFlow flow(levels, mask);
      flow.advance(20000);
      CHECK(cv::norm(flow.levels(), sketch::fill(levels, mask).levels, cv::NORM_INF) < 0.25);
    }
}

TEST_CASE("Heat keeps to the range it began with and the range shrinks", "[sketch][heat]") {
  const cv::Size size(32, 24);
  const cv::Mat levels = random_levels(size, 1, 5);
  sketch::HeatFlow flow(levels, cv::Mat(size, CV_8U, cv::Scalar(0)));
  double low = 0, high = 0;
  cv::minMaxLoc(levels, &low, &high);
  for (int i = 0; i < 60; ++i) {
    flow.advance(1 + i % 5);
    double least = 0, most = 0;
    cv::minMaxLoc(flow.levels(), &least, &most);
    CHECK(least >= low - 1e-4);
    CHECK(most <= high + 1e-4);
    low = least;
    high = most;
  }
  CHECK(high - low < 20);
}

TEST_CASE("Heat keeps planes and held pixels and, with nothing held, the mean", "[sketch][heat]") {
  const cv::Size size(40, 25);
  cv::Mat plane(size, CV_32F), border(size, CV_8U, cv::Scalar(1));
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      plane.at<float>(y, x) = 20.0F + 3.0F * static_cast<float>(x) - 0.5F * static_cast<float>(y);
  border(cv::Rect(1, 1, size.width - 2, size.height - 2)) = 0;
  sketch::HeatFlow still(plane, border);
  still.advance(500);
  CHECK(cv::norm(still.levels(), plane, cv::NORM_INF) == 0);  // halves are exact in binary

  cv::Mat torn = plane.clone();
  torn.setTo(0, border == 0);
  sketch::HeatFlow mending(torn, border);
  mending.advance(6000);
  CHECK(cv::norm(mending.levels(), plane, cv::NORM_INF) < 0.02);

  const cv::Mat levels = random_levels(size, 1, 6), mask = some_held(size, 0.2, 7);
  sketch::HeatFlow held(levels, mask), free(levels, cv::Mat(size, CV_8U, cv::Scalar(0)));
  held.advance(77);
  free.advance(3000);
  const cv::Mat after = held.levels();
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (mask.at<uchar>(y, x) != 0) CHECK(after.at<float>(y, x) == levels.at<float>(y, x));
  CHECK_THAT(cv::mean(free.levels())[0], WithinAbs(cv::mean(levels)[0], 0.01));
}

TEST_CASE("Heat decays a cosine at its own rate", "[sketch][heat]") {
  // cos(π (x + ½) k / w) is an eigenvector of the insulated 5-point stencil.
  const int width = 64, k = 3;
  cv::Mat wave(5, width, CV_32F);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < width; ++x)
      wave.at<float>(y, x) = static_cast<float>(100 * std::cos(std::numbers::pi * (x + 0.5) * k / width));
  sketch::HeatFlow flow(wave, cv::Mat(wave.size(), CV_8U, cv::Scalar(0)), 0.25);
  flow.advance(100);
  const double factor = std::pow(1 - 0.25 * 2 * (1 - std::cos(std::numbers::pi * k / width)), 100);
  CHECK(cv::norm(flow.levels(), wave * factor, cv::NORM_INF) < 0.01);
}

TEST_CASE("Heat on odd frames and on bad input", "[sketch][heat]") {
  for (const cv::Size size : {cv::Size(1, 1), {3, 1}, {1, 20}, {3, 31}}) {
    const cv::Mat levels = random_levels(size, 1, 10);
    sketch::HeatFlow flow(levels, cv::Mat(size, CV_8U, cv::Scalar(0)));
    flow.advance(5000);
    CHECK(cv::norm(flow.levels(), cv::Mat(size, CV_32F, cv::mean(levels)), cv::NORM_INF) < 0.1);
  }
  const cv::Size size(8, 6);
  cv::Mat levels = random_levels(size, 1, 11);
  const cv::Mat mask(size, CV_8U, cv::Scalar(0));
  CHECK_THROWS_AS(sketch::HeatFlow(levels, mask, 0.26), core::InputError);
  CHECK_THROWS_AS(sketch::HeatFlow(levels, mask, 0), core::InputError);
  CHECK_THROWS_AS(sketch::HeatFlow(levels, cv::Mat(2, 2, CV_8U)), core::InputError);
  CHECK_THROWS_AS(sketch::HeatFlow(cv::Mat(), cv::Mat()), core::InputError);
  CHECK_THROWS_AS(sketch::HeatFlow(levels, mask).advance(-1), core::InputError);
  levels.at<float>(0, 0) = std::numeric_limits<float>::infinity();
  CHECK_THROWS_AS(sketch::HeatFlow(levels, mask), core::InputError);
}
