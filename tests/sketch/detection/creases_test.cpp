// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/creases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using sketch::CreaseKind;
using sketch::CreaseMap;
using sketch::CreasePoint;
using sketch::ScaleSpace;

namespace {

const cv::Size kCreasesSize{100, 100};
constexpr sketch::CreaseLimits kLimits{2.4, 4};

struct Straight {
  Point origin;
  double theta = 0;
  /// Signed distance to the line, positive to the right of its direction.
  double operator()(Point p) const { return graph::dot(p - origin, {-std::sin(theta), std::cos(theta)}); }
};

Straight at_angle(int k) {
  return {{49.5 + 0.3 * std::cos(k), 49.5 + 0.4 * std::sin(2.0 * k)}, 0.02 + std::numbers::pi * k / 8};
}

cv::Mat1f gaussian_line(const Straight& line, double spread, double height) {
  return draw(kCreasesSize,
              [&](Point p) { return 120 + height * std::exp(-0.5 * std::pow(line(p) / spread, 2)); });
}

sketch::NoiseLevels flat_ground(const ScaleSpace& space) {
  return sketch::measure_noise_levels(space, 0.29);
}

/// The points well inside the frame, of which those on the line itself.
template <class Check>
std::size_t check_points(const CreaseMap& map, const Straight& line, double reach, Check check) {
  std::size_t count = 0;
  for (const CreasePoint& p : map.points)
    if (well_inside(p.position, kCreasesSize, 25) && std::abs(line(p.position)) < reach) {
      check(p);
      ++count;
    }
  return count;
}

}  // namespace

TEST_CASE("A Gaussian line is found in its place, at its scale, with its height") {
  for (int k = 0; k < 8; ++k)
    for (const std::size_t level : {1U, 2U, 3U})
      for (const double height : {80.0, -80.0}) {
        const Straight line = at_angle(k);
        const ScaleSpace probe = sketch::scale_space(cv::Mat1f(3, 3, 0.0F), 1.2, 5);
        const double spread = probe[level].sigma;
        const ScaleSpace space = sketch::scale_space(gaussian_line(line, spread, height), 1.2, 5);
        const CreaseKind kind = height > 0 ? CreaseKind::ridge : CreaseKind::valley;
        sketch::CreaseLines lines = sketch::find_lines(space, flat_ground(space), kLimits);
        CreaseMap& map = kind == CreaseKind::ridge ? lines.ridges : lines.valleys;
        sketch::thin_parallel_points(map, space);
        INFO("angle " << line.theta << ", spread " << spread << ", height " << height);
        std::size_t far_scale = 0;
        double contrast = 0;
        const std::size_t count = check_points(map, line, 2, [&](const CreasePoint& p) {
          REQUIRE_THAT(line(p.position), WithinAbs(0, 0.1));
          REQUIRE(graph::orientation_difference(p.theta, line.theta) < 0.03);
          far_scale += std::abs(p.level - static_cast<int>(level)) > 1 ? 1U : 0U;
          contrast += p.contrast;
        });
        REQUIRE(count >= 45);  // one in each row or column of the 50 that count
        CHECK(far_scale <= count / 10);
        CHECK_THAT(contrast / static_cast<double>(count), WithinRel(80, 0.1));
      }
}

TEST_CASE("A blurred step is found in its place, with its height and the brighter side on the right") {
  for (int k = 0; k < 16; ++k)
    for (const double blur : {1.2, 2.4}) {
      const Straight line = at_angle(k);
      const auto image = draw(kCreasesSize, [&](Point p) { return 60 + 80 * reached(line(p), blur); });
      const ScaleSpace space = sketch::scale_space(image, 1.2, 5);
      CreaseMap map = sketch::find_steps(space, flat_ground(space), kLimits);
      sketch::thin_parallel_points(map, space);
      INFO("angle " << line.theta << ", blur " << blur);
      const std::size_t count = check_points(map, line, 2, [&](const CreasePoint& p) {
        REQUIRE_THAT(line(p.position), WithinAbs(0, 0.2));
        REQUIRE(graph::dot(unit(p.theta), unit(line.theta)) > 0.999);
        REQUIRE_THAT(p.contrast, WithinRel(80, 0.3));
      });
      REQUIRE(count >= 45);
    }
}

TEST_CASE("A map holds at most one point for a pixel, near its centre") {
  const auto scene = with_noise(
      draw(kCreasesSize, {ring({50, 50}, 30, 4, 1), segment({10, 20}, {90, 70}, 3, 1)}, 60, 80), 10, 1);
  const ScaleSpace space = sketch::scale_space(scene, 1.2, 5);
  const sketch::NoiseLevels ground = sketch::measure_noise_levels(space, 10);
  for (const CreaseMap& map :
       {sketch::find_lines(space, ground, kLimits).ridges, sketch::find_lines(space, ground, kLimits).valleys,
        sketch::find_steps(space, ground, kLimits)}) {
    std::vector<int> uses(map.points.size(), 0);
    for (int y = 0; y < kCreasesSize.height; ++y)
      for (int x = 0; x < kCreasesSize.width; ++x) {
        const int i = map.index(y, x);
        if (i < 0) continue;
        const CreasePoint& p = map.points[static_cast<std::size_t>(i)];
        ++uses[static_cast<std::size_t>(i)];
        REQUIRE(std::abs(p.position.x - x) <= 0.6);
        REQUIRE(std::abs(p.position.y - y) <= 0.6);
        REQUIRE(p.contrast >= kLimits.contrast);
        REQUIRE(p.significance >= kLimits.significance);
      }
    REQUIRE(!uses.empty());
    REQUIRE(std::all_of(uses.begin(), uses.end(), [](int u) { return u == 1; }));
  }
}

TEST_CASE("The flanks of a line are taken away, a step of its own stays") {
  for (int k = 0; k < 8; ++k) {
    const Straight line = at_angle(k);
    const auto steps_near = [&](const cv::Mat1f& image, bool without_flanks) {
      const ScaleSpace space = sketch::scale_space(image, 1.2, 5);
      CreaseMap steps = sketch::find_steps(space, flat_ground(space), kLimits);
      if (without_flanks)
        sketch::remove_flanks(steps, sketch::find_lines(space, flat_ground(space), kLimits).ridges, space,
                              1.6);
      return check_points(steps, line, 12, [](const CreasePoint&) {});
    };
    INFO("angle " << line.theta);
    const cv::Mat1f alone = gaussian_line(line, 1.7, 80);
    REQUIRE(steps_near(alone, false) > 90);  // both flanks
    CHECK(steps_near(alone, true) <= 15);
    const cv::Mat1f stepped = draw(kCreasesSize, [&](Point p) {
      return 40 * std::exp(-0.5 * std::pow(line(p) / 1.7, 2)) + 60 + 80 * reached(line(p) - 10, 1.2);
    });
    REQUIRE(steps_near(stepped, true) >= 45);
  }
}

TEST_CASE("A faint line beside a strong one of the other sign is its lobe, a strong one is not") {
  for (int k = 0; k < 8; ++k) {
    const Straight line = at_angle(k),
                   beside{line.origin + unit(line.theta + std::numbers::pi / 2) * 8, line.theta};
    const auto valleys = [&](double depth, bool without_lobes) {
      const auto image = draw(kCreasesSize, [&](Point p) {
        return 120 + 80 * std::exp(-0.5 * std::pow(line(p) / 1.7, 2)) -
               depth * std::exp(-0.5 * std::pow(beside(p) / 1.7, 2));
      });
      const ScaleSpace space = sketch::scale_space(image, 1.2, 5);
      CreaseMap map = sketch::find_lines(space, flat_ground(space), kLimits).valleys;
      if (without_lobes)
        sketch::remove_lobes(map, sketch::find_lines(space, flat_ground(space), kLimits).ridges, space);
      return check_points(map, beside, 2, [](const CreasePoint&) {});
    };
    INFO("angle " << line.theta);
    REQUIRE(valleys(12, false) >= 45);
    CHECK(valleys(12, true) <= 15);
    REQUIRE(valleys(60, true) >= 45);
  }
}

TEST_CASE("Thinning keeps one line of points") {
  for (int k = 0; k < 8; ++k) {
    const Straight line = at_angle(k);
    const ScaleSpace space = sketch::scale_space(gaussian_line(line, 2.4, 80), 1.2, 5);
    CreaseMap map = sketch::find_lines(space, flat_ground(space), kLimits).ridges;
    sketch::thin_parallel_points(map, space);
    for (const CreasePoint& p : map.points)
      for (const CreasePoint& q : map.points) {
        const Point way = q.position - p.position;
        const double across = std::abs(graph::dot(way, unit(p.theta + std::numbers::pi / 2)));
        const double along = std::abs(graph::dot(way, unit(p.theta)));
        INFO("angle " << line.theta << " at " << p.position.x << ", " << p.position.y);
        REQUIRE(!(across > 0.5 && across < 1.5 && along < 0.5 && well_inside(p.position, kCreasesSize, 8)));
      }
  }
}
