// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/amplitude.hpp"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::Patch;

namespace {

double blurred_bar(double d, double width, double blur) {
  const auto phi = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  return phi((d + width / 2) / blur) - phi((d - width / 2) / blur);
}

Patch bar_at(Point place, double theta, float contrast) {
  Patch patch;
  patch.type = graph::PatchType::bar;
  patch.position = place, patch.theta = theta, patch.width = 4, patch.blur = 1.2;
  patch.left.fill(80), patch.right.fill(80), patch.middle.fill(80 + contrast);
  patch.contrast = double{contrast} * blurred_bar(0, 4, 1.2);
  return patch;
}

/// Distance of a point from the line through the patch.
double across(const Patch& patch, Point p) {
  return dot(p - patch.position, {-std::sin(patch.theta), std::cos(patch.theta)});
}

}  // namespace

TEST_CASE("A patch's amplitude is the share of it that the frame shows", "[amplitude]") {
  for (const double theta : {0.0, 0.7, 2.0})
    for (const double share : {-0.5, 0.0, 0.4, 1.0, 1.7}) {
      const Patch patch = bar_at({40.3, 37.6}, theta, 50);
      const cv::Mat1f levels =
          draw({80, 80}, [&](Point p) { return 80 + share * 50 * blurred_bar(across(patch, p), 4, 1.2); });
      INFO("theta " << theta << ", share " << share);
      CHECK_THAT(sketch::measure_amplitude(levels, patch, 0).value, WithinAbs(share, 0.06));
    }
}

TEST_CASE("An amplitude does not depend on light, contrast or colour", "[amplitude]") {
  Patch patch = bar_at({40, 40}, 0.3, 30);
  const auto bar = [&](Point p) { return blurred_bar(across(patch, p), 4, 1.2); };
  const cv::Mat1f brighter = draw({80, 80}, [&](Point p) { return 130 + 30 * bar(p); });
  CHECK_THAT(sketch::measure_amplitude(brighter, patch, 0).value, WithinAbs(1, 0.06));
  // A red line as bright as its green surroundings.
  patch.left = {20, 100, 30}, patch.right = {20, 100, 30}, patch.middle = {20, 60, 110};
  std::vector<cv::Mat> channels;
  for (std::size_t c = 0; c < 3; ++c)
    channels.push_back(draw({80, 80}, [&](Point p) {
      return double{patch.left[c]} + 0.6 * double{patch.middle[c] - patch.left[c]} * bar(p);
    }));
  cv::Mat colour;
  cv::merge(channels, colour);
  CHECK_THAT(sketch::measure_amplitude(colour, patch, 0).value, WithinAbs(0.6, 0.04));
}

TEST_CASE("A step's amplitude is that of its difference of levels", "[amplitude]") {
  Patch step;
  step.type = graph::PatchType::step;
  step.position = {40, 40}, step.theta = 1.1, step.width = 0, step.blur = 1.5, step.contrast = 60;
  step.left.fill(60), step.middle.fill(90), step.right.fill(120);
  for (const double share : {0.0, 0.5, 1.0}) {
    const cv::Mat1f levels = draw({80, 80}, [&](Point p) {
      return 90 + share * 60 * (0.5 * std::erfc(-across(step, p) / 1.5 / std::numbers::sqrt2) - 0.5);
    });
    CHECK_THAT(sketch::measure_amplitude(levels, step, 0).value, WithinAbs(share, 0.06));
  }
}

TEST_CASE("A patch beside its line finds it within the slip", "[amplitude]") {
  const Patch line = bar_at({40, 40}, 0.5, 50);
  const cv::Mat1f levels =
      draw({80, 80}, [&](Point p) { return 80 + 50 * blurred_bar(across(line, p), 4, 1.2); });
  Patch beside = line;
  beside.position = line.position + Point{-std::sin(0.5), std::cos(0.5)} * 1.5;
  CHECK(sketch::measure_amplitude(levels, beside, 0).value < 0.85);
  CHECK(sketch::measure_amplitude(levels, beside, 1.5).value > 0.92);
  CHECK_THAT(sketch::measure_amplitude(levels, beside, 1.5).slip, WithinAbs(-1.5, 0.3));
  CHECK_THAT(sketch::measure_amplitude(levels, line, 1.5).slip, WithinAbs(0, 0.3));
  // At the border, and far outside, there is a number too.
  beside.position = {0, 0};
  CHECK(std::isfinite(sketch::measure_amplitude(levels, beside, 1.5).value));
  beside.position = {-500, 900};
  CHECK(std::isfinite(sketch::measure_amplitude(levels, beside, 1.5).value));
}

TEST_CASE("An amplitude is the same of bytes, of floats and of grey in three channels", "[amplitude]") {
  cv::Mat3b bytes(60, 70);
  cv::Mat1b grey(60, 70);
  cv::theRNG().state = 5;
  cv::randu(bytes, 0, 256), cv::randu(grey, 0, 256);
  cv::Mat floats, thrice, grey_floats;
  bytes.convertTo(floats, CV_32F), grey.convertTo(grey_floats, CV_32F);
  cv::merge(std::vector<cv::Mat>(3, grey_floats), thrice);
  // Off the border, and so near to it that samples fall outside.
  for (const Point place : {Point{33.4, 28.7}, Point{3.2, 28.7}, Point{66.5, 55.1}})
    for (const double theta : {0.0, 0.9, 2.4}) {
      INFO("at " << place.x << ", " << place.y << ", theta " << theta);
      const Patch patch = bar_at(place, theta, 40);
      CHECK(sketch::measure_amplitude(bytes, patch, 1.5).value ==
            sketch::measure_amplitude(floats, patch, 1.5).value);
      CHECK_THAT(sketch::measure_amplitude(thrice, patch, 1.5).value,
                 WithinAbs(sketch::measure_amplitude(grey_floats, patch, 1.5).value, 1e-4));
      CHECK(sketch::measure_amplitude(grey, patch, 1.5).value ==
            sketch::measure_amplitude(grey_floats, patch, 1.5).value);
    }
}
