// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sketch/patches/profile_model.hpp"
#include "sketch/patches/sections.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::PatchType;
using graph::Point;

namespace {

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x * 0.70710678118654752);
}

// The best of some blurred bars. A bar's variance is blur² + width²/12; the squareness is the bar's share of
// it.
Profile best_start(const Section& section, CreaseKind kind, double spread, bool moves, double least_blur) {
  constexpr std::array<double, 3> kScales = {0.6, 1.0, 1.6};
  constexpr double kSquareness = 2.6;
  Profile best;
  best.residual = -1;
  const auto attempt = [&](double offset, double width, double blur) {
    const Profile p =
        fit_levels(section, {.offset = offset, .width = width, .blur = std::max(blur, least_blur)});
    if (best.residual >= 0 && p.residual >= best.residual) return;
    if (kind == CreaseKind::ridge && 2 * p.middle < p.left + p.right) return;
    if (kind == CreaseKind::valley && 2 * p.middle > p.left + p.right) return;
    best = p;
  };
  for (const double scale : kScales) {
    const double sd = scale * spread;
    if (kind == CreaseKind::step) {
      attempt(0, 0, sd);
      continue;
    }
    const double width = kSquareness * sd;
    attempt(0, width, std::sqrt(std::max(sd * sd - width * width / 12, 0.0)));
  }
  if (moves && best.residual >= 0)
    for (const Profile middle = best; const double aside : {-0.6 * spread, 0.6 * spread})
      attempt(aside, middle.width, middle.blur);
  if (best.residual < 0)  // no bar of this sign suits at all
    best = fit_levels(section, {.width = kind == CreaseKind::step ? 0 : 1.8 * spread, .blur = spread});
  return best;
}

Profile fit_profile(const Section& section, CreaseKind kind, std::span<const Rib> ribs,
                    const FitOptions& options) {
  constexpr int kSteps = 10;
  constexpr double kUsualBlur = 1.1, kBlurSpread = 0.4;  // px; SD of its logarithm
  const double least_blur = std::sqrt(kInterpolationVariance + 0.04);
  const ProfileBounds bounds{options.moves ? 0.5 + 0.35 * options.spread : 0, 0.8, 4.5 * options.spread + 2,
                             least_blur, 2.5 * options.spread + 1};
  const Profile start = best_start(section, kind, options.spread, options.moves, least_blur);
  const double variance = section_variance(ribs, options.noise);
  const Profile fitted =
      refine_profile(section, start, bounds, kSteps,
                     kind == CreaseKind::step ? 0 : variance / (kBlurSpread * kBlurSpread), kUsualBlur);
  const double sign = kind == CreaseKind::ridge ? 1 : -1;
  if (kind != CreaseKind::step && sign * (2 * fitted.middle - fitted.left - fitted.right) <= 0) return start;
  return fitted;
}

}  // namespace

Patch fit_patch(const cv::Mat& levels, Point at, double theta, CreaseKind kind, std::span<const Rib> ribs,
                const FitOptions& options) {
  const auto half = std::min(static_cast<std::size_t>(std::ceil((2.8 * options.spread + 1.5) / kSampleStep)),
                             (kMostSamples - 1) / 2);
  const Sections sections = sample_sections(levels, ribs, 2 * half + 1, options.axis);
  const Profile fitted = fit_profile(sections.seen, kind, ribs, options);
  Patch patch;
  patch.type = kind == CreaseKind::ridge    ? PatchType::ridge
               : kind == CreaseKind::valley ? PatchType::valley
                                            : PatchType::step;
  patch.position = at + Point{-std::sin(theta), std::cos(theta)} * fitted.offset;
  patch.theta = theta;
  patch.width = fitted.width;
  patch.blur = std::sqrt(fitted.blur * fitted.blur - kInterpolationVariance);
  const bool grey = levels.channels() == 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const Profile own = grey ? fitted : fit_levels(sections.channel[c], fitted);
    patch.left[c] = static_cast<float>(own.left);
    patch.right[c] = static_cast<float>(own.right);
    patch.middle[c] = static_cast<float>(own.middle);
  }
  if (kind == CreaseKind::step) {
    patch.contrast = fitted.right - fitted.left;
  } else {
    const double core =
        1 - 2 * normal_cdf(-0.5 * fitted.width / fitted.blur);  // what is seen of it at the centre
    patch.contrast = core * (fitted.middle - 0.5 * (fitted.left + fitted.right));
  }
  return patch;
}

Patch fit_patch(const cv::Mat& levels, Point position, double theta, CreaseKind kind, double spread,
                double length) {
  const int count = std::max(1, static_cast<int>(std::lround(length)));
  std::vector<Rib> ribs;
  const Point along{std::cos(theta), std::sin(theta)}, across{-along.y, along.x};
  for (int r = 0; r < count; ++r) ribs.push_back({position + along * (r - 0.5 * (count - 1)), across, 1});
  return fit_patch(levels, position, theta, kind, ribs, {.spread = spread});
}

}  // namespace emberfold::sketch
