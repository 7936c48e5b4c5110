// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/trial_shapes.hpp"

#include <cmath>
#include <functional>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using sketch::RampSums;

namespace {

// Three pixels in every bin, at its middle.
std::vector<RampSums> bins_of(const sketch::TrialShapes& shapes, const std::function<double(double)>& level) {
  std::vector<RampSums> bins(shapes.bins());
  for (int k = 0; k < static_cast<int>(bins.size()); ++k)
    for (int i = 0; i < 3; ++i) {
      const double across = (k - shapes.half) * shapes.bin;
      bins[static_cast<std::size_t>(k)].add(level(across), across);
    }
  return bins;
}

RampSums sum_of(const std::vector<RampSums>& bins, const sketch::TrialShape& shape) {
  const int half = static_cast<int>(bins.size() / 2);
  RampSums all;
  for (int k = half - shape.bins; k <= half + shape.bins; ++k) all.add(bins[static_cast<std::size_t>(k)]);
  return all;
}

}  // namespace

TEST_CASE("Steps and bars of every trial shape come back with their levels") {
  for (const double sigma : {1.2, 3.4}) {
    const auto shapes = sketch::make_trial_shapes(sigma);
    for (const auto& shape : shapes.steps) {
      const auto bins = bins_of(shapes, [&](double d) { return 40 + 50 * reached(d, shape.blur); });
      const auto fitted = sketch::fit_step(shape, bins, sum_of(bins, shape));
      CHECK_THAT(fitted.left, WithinAbs(40, 1e-3));
      CHECK_THAT(fitted.right, WithinAbs(90, 1e-3));
      CHECK_THAT(fitted.residual, WithinAbs(0, 1e-3));
    }
    for (const auto& shape : shapes.bars)
      for (const double sign : {1.0, -1.0}) {
        const auto bins = bins_of(shapes, [&](double d) {
          return bar_level(d, shape.width, shape.blur, 100, 100 + sign * 60, 110);
        });
        const auto fitted = sketch::fit_bar(shape, bins, sum_of(bins, shape), sign);
        CHECK_THAT(fitted.left, WithinAbs(100, 0.01));
        CHECK_THAT(fitted.middle, WithinAbs(100 + sign * 60, 0.01));
        CHECK_THAT(fitted.right, WithinAbs(110, 0.01));
        CHECK_THAT(fitted.residual, WithinAbs(0, 0.01));
        CHECK(sketch::fit_bar(shape, bins, sum_of(bins, shape), -sign).residual < 0);
      }
  }
}

TEST_CASE("A step that falls to the right, and an even level, are no steps") {
  const auto shapes = sketch::make_trial_shapes(1.2);
  const auto& shape = shapes.steps[1];
  const auto falling = bins_of(shapes, [&](double d) { return 90 - 50 * reached(d, shape.blur); });
  CHECK(sketch::fit_step(shape, falling, sum_of(falling, shape)).residual < 0);
  const auto even = bins_of(shapes, [](double) { return 70.0; });
  CHECK(sketch::fit_step(shape, even, sum_of(even, shape)).residual < 0);
}

TEST_CASE("Every distance within reach has a bin whose middle is nearest") {
  const auto shapes = sketch::make_trial_shapes(2.4);
  for (double d = -shapes.reach(); d <= shapes.reach(); d += 0.037) {
    const int bin = shapes.bin_at(d);
    REQUIRE(bin >= 0);
    REQUIRE(bin < static_cast<int>(shapes.bins()));
    CHECK(std::abs((bin - shapes.half) * shapes.bin - d) <= 0.5 * shapes.bin + 1e-9);
  }
}
