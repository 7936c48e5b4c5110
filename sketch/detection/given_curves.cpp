// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/given_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/fast_round.hpp"
#include "sketch/detection/crease_map.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

constexpr double kWhite = 255;

Point normal_of(const CreasePoint& p) {
  return {-std::sin(p.theta), std::cos(p.theta)};
}

/// The greatest probability at a point's pixel and its eight neighbours: the crest of a mark of one pixel.
double greatest_near(const cv::Mat1f& probability, Point at) {
  float most = 0;
  const int cx = core::fast_round(at.x), cy = core::fast_round(at.y);
  for (int y = std::max(0, cy - 1); y <= std::min(probability.rows - 1, cy + 1); ++y)
    for (int x = std::max(0, cx - 1); x <= std::min(probability.cols - 1, cx + 1); ++x)
      most = std::max(most, probability(y, x));
  return double{most};
}

/// Crest points of at least `least`, whose significance is their probability.
CreaseMap find_crests(const cv::Mat1f& probability, const ScaleSpace& marks, double least) {
  constexpr double kLeastContrast = 0.1;  // of a crest above its sides
  const NoiseLevels even{std::vector<double>(marks.size(), 1), std::vector<double>(marks.size(), 1)};
  CreaseMap all = find_lines(marks, even, {0, kLeastContrast * least * kWhite}).ridges;
  CreaseMap crests{CreaseKind::ridge, {}, make_empty_index(probability.size())};
  for (int y = 0; y < all.index.rows; ++y)
    for (int x = 0; x < all.index.cols; ++x) {
      if (all.index(y, x) < 0) continue;
      CreasePoint p = all.points[static_cast<std::size_t>(all.index(y, x))];
      p.significance = greatest_near(probability, p.position);
      if (p.significance < least) continue;
      crests.index(y, x) = static_cast<int>(crests.points.size());
      crests.points.push_back(p);
    }
  thin_parallel_points(crests, marks);
  return crests;
}

/// Kind and level of a curve in the frame, if it has one of each throughout.
struct Reading {
  CreaseKind kind = CreaseKind::ridge;
  std::size_t level = 0;
  double contrast = -1;  // grey levels, mean
};

/// The contrast of a kind at a point.
double contrast_as(CreaseKind kind, const CreasePoint& p, const ScaleLevel& level) {
  const Point n = normal_of(p);
  if (kind == CreaseKind::step)
    return 0.5 * std::abs(level.value_at(p.position + n) - level.value_at(p.position - n)) *
           step_contrast(level.sigma);
  const double bend = level.hessian_at(p.position).along(n);
  return (kind == CreaseKind::ridge ? -bend : bend) * line_contrast(level.sigma);
}

/// Lines' and steps' normalised responses grow with σ like σ^{3/2} and σ^{1/2}: contrast ÷ √σ in both cases.
Reading read_curve(const Chain& chain, const ScaleSpace& space, bool only_steps) {
  Reading best;
  double most = -1;
  for (std::size_t k = 0; k < space.size() && space[k].channel == 0; ++k)
    for (const CreaseKind kind : {CreaseKind::ridge, CreaseKind::valley, CreaseKind::step}) {
      if (only_steps && kind != CreaseKind::step) continue;
      double sum = 0;
      for (const CreasePoint& p : chain.points) sum += contrast_as(kind, p, space[k]);
      const double mean = sum / static_cast<double>(chain.points.size());
      if (mean / std::sqrt(space[k].sigma) <= most) continue;
      most = mean / std::sqrt(space[k].sigma);
      best = {kind, k, mean};
    }
  return best;
}

/// Steps have their brighter side on the right.
void turn_to_brighter(Chain& chain, const ScaleLevel& level) {
  double rise = 0;
  for (const CreasePoint& p : chain.points)
    rise += level.value_at(p.position + normal_of(p)) - level.value_at(p.position - normal_of(p));
  if (rise >= 0) return;
  std::ranges::reverse(chain.points);
  for (CreasePoint& p : chain.points)
    p.theta = std::remainder(p.theta + std::numbers::pi, 2 * std::numbers::pi);
}

}  // namespace

std::vector<Chain> trace_given_curves(const cv::Mat1f& probability, const ScaleSpace& space,
                                      GivenCurveLimits limits) {
  constexpr double kGoesOn = 0.5, kIndependent = 5, kMostNats = 7;  // of `begins`; px
  const ScaleSpace marks =
      scale_space(cv::Mat1f(cv::Mat(kWhite * probability)), space.front().sigma, limits.scales);
  std::vector<Chain> chains = remove_hooks(
      trace_curves(find_crests(probability, marks, kGoesOn * limits.begins), marks, {limits.begins}));
  for (Chain& chain : chains) {
    const Reading read = read_curve(chain, space, limits.only_steps);
    chain.kind = read.kind;
    if (chain.kind == CreaseKind::step) turn_to_brighter(chain, space[read.level]);
    for (CreasePoint& p : chain.points) {
      p.level = static_cast<int>(read.level);
      p.contrast = std::max(0.0, contrast_as(read.kind, p, space[read.level]));
      p.strength = p.contrast / std::sqrt(space[read.level].sigma);
      p.evidence = std::min(kMostNats, -std::log(std::max(1e-9, 1 - p.significance))) / kIndependent;
    }
  }
  return chains;
}

}  // namespace emberfold::sketch
