// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/trial_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sketch/patches/profile_shape.hpp"

namespace emberfold::sketch {

namespace {

TrialShape tabulate(double width, double blur, const TrialShapes& of) {
  constexpr double kPlain = 1.5;  // px of each side beyond two blurs
  TrialShape shape{width, blur, std::min(0.5 * width + 2 * blur + kPlain, of.reach()), 0, {}, {}};
  shape.bins = std::min(of.half, static_cast<int>(std::floor(shape.reach / of.bin + 0.5)));
  for (int k = -of.half; k <= of.half; ++k) {
    shape.first.push_back(static_cast<float>(blurred_step((k * of.bin + 0.5 * width) / blur)));
    shape.second.push_back(static_cast<float>(blurred_step((k * of.bin - 0.5 * width) / blur)));
  }
  return shape;
}

}  // namespace

int TrialShapes::bin_at(double across) const {
  return static_cast<int>(across / bin + half + 0.5);  // NOLINT(bugprone-incorrect-roundings): ≥ 0
}

TrialShapes make_trial_shapes(double sigma) {
  constexpr double kSharpest = 0.45;  // px: a pixel is 0.29, interpolated curves are off by as much again
  TrialShapes shapes;
  shapes.bin = std::max(0.5, 0.25 * sigma);
  shapes.half = static_cast<int>(std::ceil((3 + 3 * sigma) / shapes.bin));
  for (const double blur : {0.4, 0.8, 1.3})
    shapes.steps.push_back(tabulate(0, std::max(blur * sigma, kSharpest), shapes));
  for (const double size : {0.65, 0.85, 1.1, 1.45})
    for (const double box : {0.2, 0.6, 0.95})  // share of the variance that is the core's
      shapes.bars.push_back(tabulate(std::sqrt(12 * box) * size * sigma,
                                     std::max(std::sqrt(1 - box) * size * sigma, kSharpest), shapes));
  return shapes;
}

TrialLevels fit_step(const TrialShape& shape, std::span<const RampSums> bins, const RampSums& all) {
  const int half = static_cast<int>(bins.size() / 2);
  double sp = 0, spp = 0, spi = 0;
  for (int k = half - shape.bins; k <= half + shape.bins; ++k) {
    const RampSums& bin = bins[static_cast<std::size_t>(k)];
    const double p = double{shape.first[static_cast<std::size_t>(k)]};
    sp += bin.n * p, spp += bin.n * p * p, spi += bin.i * p;
  }
  const double pp = spp - sp * sp / all.n, pi = spi - sp * all.i / all.n;
  if (pp < 1e-6 || pi <= 0) return {};
  const double rise = pi / pp, left = (all.i - rise * sp) / all.n;
  return {std::max(0.0, all.ii - all.i * all.i / all.n - rise * pi), left, left + 0.5 * rise, left + rise};
}

TrialLevels fit_bar(const TrialShape& shape, std::span<const RampSums> bins, const RampSums& all,
                    double sign) {
  const int half = static_cast<int>(bins.size() / 2);
  double sa = 0, sb = 0, saa = 0, sab = 0, sbb = 0, sai = 0, sbi = 0;  // level = left + a·first + b·second
  for (int k = half - shape.bins; k <= half + shape.bins; ++k) {
    const RampSums& bin = bins[static_cast<std::size_t>(k)];
    const double a = double{shape.first[static_cast<std::size_t>(k)]},
                 b = double{shape.second[static_cast<std::size_t>(k)]};
    sa += bin.n * a, sb += bin.n * b, saa += bin.n * a * a, sab += bin.n * a * b, sbb += bin.n * b * b;
    sai += bin.i * a, sbi += bin.i * b;
  }
  const double n = all.n, aa = saa - sa * sa / n, ab = sab - sa * sb / n, bb = sbb - sb * sb / n,
               ai = sai - sa * all.i / n, bi = sbi - sb * all.i / n, det = aa * bb - ab * ab;
  if (!(det > 1e-6 * aa * bb)) return {};
  const double a = (ai * bb - bi * ab) / det, b = (bi * aa - ai * ab) / det;
  if (sign * a <= 0 || sign * b >= 0) return {};
  const double left = (all.i - a * sa - b * sb) / n;
  return {std::max(0.0, all.ii - all.i * all.i / n - a * ai - b * bi), left, left + a, left + a + b};
}

}  // namespace emberfold::sketch
