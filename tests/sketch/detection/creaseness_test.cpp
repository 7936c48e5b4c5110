// SPDX-License-Identifier: Apache-2.0
// Creaseness against closed forms: straight ridges, cones, saddles, flat ground.
#include "sketch/detection/creaseness.hpp"

#include <cmath>
#include <numbers>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using sketch::creaseness;

namespace {

const cv::Size kCreasenessSize{80, 80};
constexpr Point kMiddle{40, 40};

sketch::ScaleLevel smoothed(const std::function<double(Point)>& level) {
  return sketch::scale_space(draw(kCreasenessSize, level), 1.2, 1).front();
}

}  // namespace

TEST_CASE("On a straight ridge creaseness is 1, in a valley -1, on a slope 0") {
  // One pixel to either side of the middle the gradient points back to it: −div w = (1 + 1)/2 along an axis.
  for (const double sign : {1.0, -1.0}) {
    const auto level =
        smoothed([&](Point p) { return 100 + sign * 60 * std::exp(-std::pow(p.x - 40, 2) / 18); });
    for (int y = 20; y <= 60; y += 5)
      CHECK_THAT(creaseness(level, {40, double(y)}, 1), WithinAbs(sign, 0.01));
  }
  for (const double angle : {0.0, 0.4, 1.1}) {
    const auto level = smoothed([&](Point p) { return 3 * graph::dot(p, unit(angle)); });
    CHECK_THAT(creaseness(level, kMiddle, 1), WithinAbs(0, 1e-3));
  }
}

TEST_CASE("Across a ridge at any angle it is between 1 and the square root of 2") {
  for (const double angle : {0.3, std::numbers::pi / 4, 1.2}) {
    const Point across = unit(angle);
    const auto level = smoothed(
        [&](Point p) { return 100 + 60 * std::exp(-std::pow(graph::dot(p - kMiddle, across), 2) / 18); });
    const double here = creaseness(level, kMiddle, 1);
    CHECK(here >= std::abs(across.x) + std::abs(across.y) - 0.05);
    CHECK(here <= std::sqrt(2.0) + 0.05);
  }
}

TEST_CASE("On a cone's slope creaseness is the level lines' curvature") {
  for (const double sign : {1.0, -1.0}) {
    const auto level = smoothed([&](Point p) { return 128 - sign * 4 * graph::distance(p, kMiddle); });
    for (const double r : {8.0, 12.0, 20.0})
      for (const double angle : {0.0, 0.9, 2.5}) {
        // At a pixel's centre, where it is measured.
        const Point p = kMiddle + Point{std::round(r * std::cos(angle)), std::round(r * std::sin(angle))};
        CHECK_THAT(creaseness(level, p, 1), WithinAbs(sign / graph::distance(p, kMiddle), 0.15 / r));
      }
  }
}

TEST_CASE("Creaseness goes on through a saddle of a ridge and vanishes on flat ground") {
  // The ridge's height dips to a quarter at y = 40.
  const auto level = smoothed([&](Point p) {
    const double dip = 1 - 0.75 * std::exp(-std::pow(p.y - 40, 2) / 128);
    return 60 + 80 * dip * std::exp(-std::pow(p.x - 40, 2) / 8);
  });
  for (int y = 20; y <= 60; ++y) CHECK(creaseness(level, {40, double(y)}, 1) >= 0.5);
  const auto flat = smoothed([](Point) { return 100.0; });
  CHECK(creaseness(flat, kMiddle, 1) == 0);
  for (const Point corner : {Point{0, 0}, Point{79, 79}, Point{-5, 200}})
    CHECK(std::abs(creaseness(level, corner, 1)) <= 2);
}
