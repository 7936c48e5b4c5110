// SPDX-License-Identifier: Apache-2.0
// Bars drawn by formula: distance of the patches from their axis, and fitted widths.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "sketch/extract.hpp"
#include "tests/bench/figures/measures.hpp"
#include "tests/support/sketch_scene.hpp"

namespace emberfold::figures {

namespace {

const cv::Size kSize{140, 140};
constexpr int kAngles = 24;
constexpr double kBlur = 1, kGround = 60, kContrast = 80, kMargin = 12;

struct Case {
  const char* name;
  double noise;
  double left;  ///< level left of the bar, as a share of the way up to its middle
  double position_target;
  double width_target;  ///< 0: none
};

struct Sums {
  double squares = 0, width = 0, patches = 0, expected = 0, others = 0;
};

/// One bar through the whole frame, never twice the same to the pixel grid; a ridge and a valley by turns.
void add_bar(Sums& sums, const Case& c, double width, int k) {
  const double theta = 0.013 + std::numbers::pi * k / kAngles, sign = k % 2 == 0 ? 1 : -1;
  const Point origin{69.5 + 0.37 * std::cos(k * 1.7), 69.5 + 0.41 * std::sin(k * 2.3)};
  const Point normal = test::unit(theta + std::numbers::pi / 2);
  const auto across = [&](Point p) { return graph::dot(p - origin, normal); };
  cv::Mat1f frame = test::draw(kSize, [&](Point p) {
    return (sign > 0 ? kGround : kGround + 2 * kContrast) +
           sign * kContrast * test::bar_level(across(p), width, kBlur, c.left, 1, 0);
  });
  if (c.noise > 0) frame = test::with_noise(frame, c.noise, static_cast<std::uint64_t>(k + 1));
  const graph::AttributeGraph found = sketch::extract(frame, usual_options());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const graph::Patch& p = found.patch(i);
    if (!test::well_inside(p.position, kSize, kMargin)) continue;
    const double d = across(p.position);
    if (graph::on_step(p) || p.contrast * sign < 0 || std::abs(d) > 3) {
      sums.others += 1;
      continue;
    }
    sums.patches += 1;
    sums.squares += d * d;
    sums.width += std::abs(p.width - width);
  }
  // The length of the axis inside the margin, in patches of the usual spacing.
  for (double s = -100; s < 100; s += 0.5)
    if (test::well_inside(origin + test::unit(theta) * s, kSize, kMargin))
      sums.expected += 0.5 / usual_options().spacing;
}

}  // namespace

std::vector<Row> profiles(const Inputs& /*inputs*/) {
  std::vector<Row> rows;
  for (const Case& c :
       {Case{"clean", 0, 0, 0.03, 0.3}, Case{"noise 15", 15, 0, 0.1, 0.3},
        Case{"one side 50 %", 0, 0.5, 0.1, 0}, Case{"one side 50 %, noise 15", 15, 0.5, 0, 0}})
    for (const double width : {3.0, 5.0, 8.0}) {
      Sums sums;
      for (int k = 0; k < kAngles; ++k) add_bar(sums, c, width, k);
      const std::string name =
          "profiles: bar of " + std::to_string(static_cast<int>(width)) + " px, " + c.name + ": ";
      const auto target = [](double value) {
        return value > 0 ? std::optional<Target>(at_most(value)) : std::nullopt;
      };
      rows.push_back(
          {name + "place, RMS", std::sqrt(sums.squares / sums.patches), 3, "px", target(c.position_target)});
      rows.push_back({name + "width off by", sums.width / sums.patches, 3, "px", target(c.width_target)});
      rows.push_back({name + "axis covered", sums.patches / sums.expected, 2, "", at_least(0.9)});
      rows.push_back({name + "other patches", sums.others / sums.expected, 2, "", {}});
    }
  return rows;
}

}  // namespace emberfold::figures
