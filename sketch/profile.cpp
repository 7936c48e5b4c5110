// SPDX-License-Identifier: Apache-2.0
#include "sketch/profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sketch/profile_model.hpp"
#include "sketch/row_pass.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::PatchType;
using graph::Point;

namespace {

constexpr double kInterpolation =
    1.0 / 6;  // px²: the variance that weights between two pixels have on the mean

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x * 0.70710678118654752);
}

// The image across the patch: means over its ribs, of each of the frame's channels and of luma or another
// axis of colour.
struct Sections {
  std::array<Section, 3> channel;
  Section seen;
};

// Between four pixels: `right` and `below` are how far on those to the right and below lie.
inline float between(const float* pixel, std::ptrdiff_t right, std::ptrdiff_t below, float fx, float fy) {
  const float upper = (1 - fx) * pixel[0] + fx * pixel[right];
  const float lower = (1 - fx) * pixel[below] + fx * pixel[below + right];
  return (1 - fy) * upper + fy * lower;
}

// Where the samples of a rib lie: the pixel to their upper left, as a distance from the frame's first, and
// how far beyond it.
struct Spots {
  std::array<int, kMostSamples> pixel;
  Samples fx, fy;
};

EMBERFOLD_ROW_PASS void place_spots(const Rib& rib, int count, int step, int stride, Spots& spots) {
  const int last = count - 1;
  const double first = 0.5 * static_cast<double>(last);
  const double px = rib.position.x, py = rib.position.y, ax = rib.across.x, ay = rib.across.y;
  for (int i = 0; i < count; ++i) {
    const double d = kSampleStep * (static_cast<double>(std::min(i, last)) - first);
    const auto x = static_cast<float>(px + ax * d), y = static_cast<float>(py + ay * d);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const auto at = static_cast<std::size_t>(i);
    spots.pixel[at] = y0 * stride + x0 * step;
    spots.fx[at] = x - static_cast<float>(x0);
    spots.fy[at] = y - static_cast<float>(y0);
  }
}

EMBERFOLD_ROW_PASS void add_spots(const float* __restrict frame, const Spots& spots, int count, int step,
                                  int stride, float weight, float* __restrict level) {
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    level[i] += weight * between(frame + spots.pixel[at], step, stride, spots.fx[at], spots.fy[at]);
  }
}

// Adds the levels along a rib; beyond the frame those of its border.
void add_rib(const cv::Mat& levels, const Rib& rib, float weight, std::span<Section> sections) {
  const std::size_t count = sections[0].count;
  const auto channels = static_cast<std::ptrdiff_t>(sections.size());
  const auto stride = static_cast<std::ptrdiff_t>(levels.step1());
  const auto* first = levels.ptr<float>();
  const auto inside = [&](double d) {
    const Point q = rib.position + rib.across * d;
    return q.x >= 0 && q.y >= 0 && q.x < levels.cols - 1.001 && q.y < levels.rows - 1.001;
  };
  if (inside(sections[0].place(0)) && inside(sections[0].place(count - 1))) {
    const int samples = static_cast<int>(count), step = static_cast<int>(channels);
    Spots spots;  // written as far as it is read
    place_spots(rib, samples, step, static_cast<int>(stride), spots);
    for (Section& section : sections)
      add_spots(first++, spots, samples, step, static_cast<int>(stride), weight, section.level.data());
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Point q = rib.position + rib.across * sections[0].place(i);
    const auto x = static_cast<float>(std::clamp(q.x, 0.0, levels.cols - 1.0)),
               y = static_cast<float>(std::clamp(q.y, 0.0, levels.rows - 1.0));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float* pixel = first + y0 * stride + x0 * channels;
    for (Section& section : sections)
      section.level[i] +=
          weight * between(pixel++, x0 + 1 < levels.cols ? channels : 0, y0 + 1 < levels.rows ? stride : 0,
                           x - static_cast<float>(x0), y - static_cast<float>(y0));
  }
}

Sections cut_across(const cv::Mat& levels, std::span<const Rib> ribs, std::size_t count,
                    const std::array<float, 3>& axis) {
  const auto channels = static_cast<std::size_t>(levels.channels());
  double total = 0;
  for (const Rib& rib : ribs) total += rib.weight;
  Sections sections;
  for (Section& section : sections.channel) section.count = count;
  for (const Rib& rib : ribs)
    add_rib(levels, rib, static_cast<float>(rib.weight / total), std::span(sections.channel).first(channels));
  sections.seen = sections.channel[0];
  if (channels == 1) return sections;
  for (std::size_t i = 0; i < count; ++i) {
    const auto level = [&](std::size_t c) { return sections.channel[c].level[i]; };
    sections.seen.level[i] = axis[0] * level(0) + axis[1] * level(1) + axis[2] * level(2);
  }
  return sections;
}

// The best of some blurred bars. A bar's variance is blur² + width²/12; the squareness says how much of it is
// the bar's.
Profile best_start(const Section& section, CreaseKind kind, double spread, bool moves, double least_blur) {
  constexpr std::array<double, 3> kScales = {0.6, 1.0, 1.6};
  constexpr double kSquareness = 2.6;
  Profile best;
  best.residual = -1;
  const auto attempt = [&](double offset, double width, double blur) {
    const Profile p =
        with_levels(section, {.offset = offset, .width = width, .blur = std::max(blur, least_blur)});
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
    best = with_levels(section, {.width = kind == CreaseKind::step ? 0 : 1.8 * spread, .blur = spread});
  return best;
}

Profile fit_profile(const Section& section, CreaseKind kind, std::span<const Rib> ribs,
                    const FitOptions& options) {
  constexpr int kSteps = 10;
  constexpr double kUsualBlur = 1.1, kBlurSpread = 0.4;  // px; SD of its logarithm
  const double least_blur = std::sqrt(kInterpolation + 0.04);
  const ProfileBounds bounds{options.moves ? 0.5 + 0.35 * options.spread : 0, 0.8, 4.5 * options.spread + 2,
                             least_blur, 2.5 * options.spread + 1};
  const Profile start = best_start(section, kind, options.spread, options.moves, least_blur);
  // Neighbouring samples share half of their noise: twice its variance counts.
  double sum = 0, squares = 0;
  for (const Rib& rib : ribs) {
    sum += rib.weight;
    squares += rib.weight * rib.weight;
  }
  const double variance = 2 * options.noise * options.noise * squares / (sum * sum);
  const Profile fitted =
      refine(section, start, bounds, kSteps,
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
  const Sections sections = cut_across(levels, ribs, 2 * half + 1, options.axis);
  const Profile fitted = fit_profile(sections.seen, kind, ribs, options);
  Patch patch;
  patch.type = kind == CreaseKind::ridge    ? PatchType::ridge
               : kind == CreaseKind::valley ? PatchType::valley
                                            : PatchType::step;
  patch.position = at + Point{-std::sin(theta), std::cos(theta)} * fitted.offset;
  patch.theta = theta;
  patch.width = fitted.width;
  patch.blur = std::sqrt(fitted.blur * fitted.blur - kInterpolation);
  const bool grey = levels.channels() == 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const Profile own = grey ? fitted : with_levels(sections.channel[c], fitted);
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
