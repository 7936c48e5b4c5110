// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/scale_space.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <opencv2/core.hpp>

#include "sketch/detection/creases.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using sketch::ScaleLevel;
using sketch::ScaleSpace;

namespace {

// So far from the border that its mirroring is not seen: the kernels of all five levels add up to 4 Σσ.
constexpr int kMargin = 48;

}  // namespace

TEST_CASE("The levels' scales grow by √2") {
  const ScaleSpace space = sketch::scale_space(cv::Mat1f(20, 30, 7.0F), 1.2, 5);
  REQUIRE(space.size() == 5);
  for (std::size_t i = 0; i < space.size(); ++i) {
    REQUIRE_THAT(space[i].sigma, WithinRel(1.2 * std::pow(std::sqrt(2.0), static_cast<double>(i)), 1e-12));
    REQUIRE(space[i].smooth.size() == cv::Size(32, 22));
  }
}

TEST_CASE("Derivatives of a quadratic image are exact at every scale") {
  // A Gaussian leaves second derivatives of a quadratic as they are, and central differences are exact.
  const auto image = draw({140, 130}, [](Point p) {
    const double x = p.x - 70, y = p.y - 65;
    return 100 + 0.4 * x - 0.7 * y + 0.005 * x * x - 0.008 * x * y + 0.003 * y * y;
  });
  for (const ScaleLevel& level : sketch::scale_space(image, 1.2, 5))
    for (int y = kMargin; y < 130 - kMargin; y += 3)
      for (int x = kMargin; x < 140 - kMargin; x += 3) {
        const sketch::Hessian h = level.hessian(x, y);
        REQUIRE_THAT(static_cast<double>(h.xx), WithinAbs(0.01, 1e-4));
        REQUIRE_THAT(static_cast<double>(h.xy), WithinAbs(-0.008, 1e-4));
        REQUIRE_THAT(static_cast<double>(h.yy), WithinAbs(0.006, 1e-4));
        const Point g = level.gradient(x, y);
        REQUIRE_THAT(g.x, WithinAbs(0.4 + 0.01 * (x - 70) - 0.008 * (y - 65), 1e-4));
        REQUIRE_THAT(g.y, WithinAbs(-0.7 - 0.008 * (x - 70) + 0.006 * (y - 65), 1e-4));
      }
}

TEST_CASE("Smoothing a Gaussian hill adds the variances") {
  const double s = 3;
  const Point top{64.3, 63.6};
  const auto image = draw(
      {128, 128}, [&](Point p) { return 100 * std::exp(-0.5 * std::pow(graph::distance(p, top) / s, 2)); });
  for (const ScaleLevel& level : sketch::scale_space(image, 1.2, 5)) {
    const double spread2 = s * s + level.sigma * level.sigma;
    for (int y = 50; y < 78; ++y)
      for (int x = 50; x < 78; ++x) {
        const double dx = x - top.x, dy = y - top.y;
        const double value = 100 * s * s / spread2 * std::exp(-0.5 * (dx * dx + dy * dy) / spread2);
        const double peak = 100 * s * s / spread2;
        REQUIRE_THAT(level.value_at({static_cast<double>(x), static_cast<double>(y)}),
                     WithinAbs(value, 2e-3 * peak));
        // Differences over ±1 px see a hill that is a little broader: by 1/3 px² for the first derivative,
        // 1/6 px² for the second.
        const sketch::Hessian h = level.hessian(x, y);
        const Point g = level.gradient(x, y);
        const double first = 0.03 * peak / std::sqrt(spread2), second = 0.06 * peak / spread2;
        REQUIRE_THAT(g.x, WithinAbs(-dx / spread2 * value, first));
        REQUIRE_THAT(g.y, WithinAbs(-dy / spread2 * value, first));
        REQUIRE_THAT(static_cast<double>(h.xx), WithinAbs((dx * dx / spread2 - 1) / spread2 * value, second));
        REQUIRE_THAT(static_cast<double>(h.xy), WithinAbs(dx * dy / spread2 / spread2 * value, second));
        REQUIRE_THAT(static_cast<double>(h.yy), WithinAbs((dy * dy / spread2 - 1) / spread2 * value, second));
      }
  }
}

TEST_CASE("Noise gains are those of measured white noise") {
  constexpr int kSize = 512;
  const auto noise = with_noise(cv::Mat1f(kSize, kSize, 0.0F), 1, 11);
  for (const ScaleLevel& level : sketch::scale_space(noise, 1.2, 5)) {
    double first = 0, second = 0, count = 0;
    for (int y = kMargin; y < kSize - kMargin; ++y)
      for (int x = kMargin; x < kSize - kMargin; ++x) {
        const Point g = level.gradient(x, y);
        const sketch::Hessian h = level.hessian(x, y);
        first += g.x * g.x + g.y * g.y;
        second += static_cast<double>(h.xx * h.xx + h.yy * h.yy);
        count += 2;
      }
    INFO("sigma " << level.sigma);
    // Smoothed noise has about one independent value in 4πσ² pixels; four SD of an SD's estimate.
    const double independent = count / (4 * std::numbers::pi * level.sigma * level.sigma);
    const double tolerance = 4 / std::sqrt(2 * independent);
    REQUIRE_THAT(std::sqrt(first / count), WithinRel(level.gradient_sd, tolerance));
    REQUIRE_THAT(std::sqrt(second / count), WithinRel(level.hessian_sd, tolerance));
  }
}

TEST_CASE("Between pixels values and second derivatives are bilinear, beyond the frame those of its border") {
  const auto image = with_noise(cv::Mat1f(20, 24, 100.0F), 30, 5);
  const ScaleSpace space = sketch::scale_space(image, 1.2, 2);
  const ScaleLevel& level = space.back();
  const auto whole = [&](int x, int y) {
    return level.value_at({static_cast<double>(x), static_cast<double>(y)});
  };
  REQUIRE_THAT(whole(4, 7), WithinAbs(static_cast<double>(level.smooth(8, 5)), 1e-4));
  REQUIRE_THAT(level.value_at({4.25, 7.5}),
               WithinAbs(0.375 * (whole(4, 7) + whole(4, 8)) + 0.125 * (whole(5, 7) + whole(5, 8)), 1e-3));
  const auto xx = [&](int x, int y) { return static_cast<double>(level.hessian(x, y).xx); };
  REQUIRE_THAT(static_cast<double>(level.hessian_at({4.25, 7.5}).xx),
               WithinAbs(0.375 * (xx(4, 7) + xx(4, 8)) + 0.125 * (xx(5, 7) + xx(5, 8)), 1e-4));
  REQUIRE(level.value_at({-5, 100}) == whole(0, 19));
  REQUIRE(level.value_at({23.4, -0.1}) == whole(23, 0));
  REQUIRE(level.hessian_at({-5, 100}).xx == level.hessian(0, 19).xx);
}

TEST_CASE("A second derivative along a direction is the quadratic form") {
  const sketch::Hessian h{2, -1, 0.5F};
  REQUIRE_THAT(h.along({1, 0}), WithinAbs(2, 1e-12));
  REQUIRE_THAT(h.along({0, 1}), WithinAbs(0.5, 1e-12));
  REQUIRE_THAT(h.along(unit(std::numbers::pi / 4)), WithinAbs(0.5 * (2 + 0.5) - 1, 1e-12));
}

TEST_CASE("The noise is found beneath structure and on flat ground") {
  for (const double sd : {1.0, 2.0, 10.0, 25.0}) {
    INFO("SD " << sd);
    REQUIRE_THAT(sketch::estimate_noise(with_noise(cv::Mat1f(256, 256, 128.0F), sd, 3)), WithinRel(sd, 0.03));
    const auto scene =
        draw({256, 256}, {segment({20, 30}, {230, 200}, 5, 1), ring({120, 130}, 60, 4, 1)}, 60, 80);
    REQUIRE_THAT(sketch::estimate_noise(with_noise(scene, sd, 3)), WithinRel(sd, 0.15));
  }
  REQUIRE(sketch::estimate_noise(cv::Mat1f(64, 64, 128.0F)) == 0.29);
  REQUIRE(sketch::estimate_noise(cv::Mat1f(1, 64, 128.0F)) == 0.29);
  REQUIRE(sketch::estimate_noise(draw({64, 64}, [](Point p) { return p.x + 2 * p.y; })) == 0.29);
}

TEST_CASE("Structureless ground is measured by its noise, textured ground by itself") {
  const double sd = 10;
  const ScaleSpace space = sketch::scale_space(with_noise(cv::Mat1f(512, 512, 128.0F), sd, 4), 1.2, 5);
  const sketch::NoiseLevels ground = sketch::measure_noise_levels(space, sd);
  const sketch::NoiseLevels quiet = sketch::measure_noise_levels(space, 0);
  for (std::size_t k = 0; k < space.size(); ++k) {
    INFO("level " << k);
    REQUIRE_THAT(ground.second[k], WithinRel(sd * space[k].hessian_sd, 0.1));
    REQUIRE_THAT(ground.first[k], WithinRel(sd * space[k].gradient_sd, 0.1));
    REQUIRE(ground.second[k] >= sd * space[k].hessian_sd);
    REQUIRE_THAT(quiet.second[k], WithinRel(sd * space[k].hessian_sd, 0.1));
  }
  // Correlated noise has less of the finest detail than white noise of the same size would have beside its
  // coarse detail.
  const auto waves =
      draw({256, 256}, [](Point p) { return 128 + 30 * std::sin(p.x / 4) * std::sin(p.y / 5); });
  const ScaleSpace textured = sketch::scale_space(waves, 1.2, 5);
  const sketch::NoiseLevels own = sketch::measure_noise_levels(textured, sketch::estimate_noise(waves));
  REQUIRE(own.second[4] > 5 * sketch::estimate_noise(waves) * textured[4].hessian_sd);
}
