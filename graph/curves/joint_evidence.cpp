// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/joint_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "graph/events/joints.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr double kReach = 35;           // px to each side of a joint that are compared
constexpr double kFarTips = 8;          // px between tips: their line has a direction
constexpr double kOutliers = 0.03;      // share of places where one curve differs by anything
constexpr double kOutliersOfTwo = 0.2;  // likewise of two curves
constexpr double kOutlierSpread = 0.5;  // of the logarithms of both there
constexpr double kCorners = 0.1;        // share of places where a curve turns by any angle
constexpr double kOtherKind = -6;       // nats: a line and a step, or lines of different sign
constexpr double kLeastSpread = 0.01;
constexpr double kLeastTurn = 0.1;  // rad
constexpr double kQuartileToSd =
    3.138;  // of sizes: the lower quartile, for the more of them may lie at joints
constexpr std::size_t kMostSamples = 200000;

double log_contrast(const Patch& patch) {
  return std::log(1 + std::abs(patch.contrast));
}
double log_width(const Patch& patch) {
  return std::log(0.1 + std::sqrt(patch.width * patch.width / 12 + patch.blur * patch.blur));
}

/// Returns the part of a way that tells of its curve: without its first patch, where both sides mix, and
/// without a tip, which fades.
std::span<const std::uint32_t> telling(const FrameArcs& frame, std::span<const std::uint32_t> way) {
  if (way.size() > 1 && frame.graph->degree(way.back()) == 1) way = way.first(way.size() - 1);
  if (way.size() > 1) way = way.subspan(1);
  return way;
}

template <class Property>
double median_of(const FrameArcs& frame, std::span<const std::uint32_t> way, Property property) {
  std::vector<double> values;
  for (const std::uint32_t v : way) values.push_back(property(frame.graph->patch(v)));
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

double log_normal(double x, double sd) {
  return -0.5 * (x / sd) * (x / sd) - std::log(sd);
}

double log_sum(double a, double b) {
  const double most = std::max(a, b);
  return most + std::log(std::exp(a - most) + std::exp(b - most));
}

/// Returns the evidence of a difference. `doubt`: a further standard deviation of what one curve shows.
double difference_evidence(double apart, double patches, const Spread& spread, double doubt,
                           double outliers) {
  const double same =
      std::sqrt(spread.along * spread.along + spread.step * spread.step * patches + doubt * doubt);
  const double two = std::sqrt(same * same + 2 * spread.between * spread.between);
  const double out = log_normal(apart, std::max(kOutlierSpread, two));
  return log_sum(std::log(1 - kOutliers) + log_normal(apart, same), std::log(kOutliers) + out) -
         log_sum(std::log(1 - outliers) + log_normal(apart, two), std::log(outliers) + out);
}

/// Ends a way at the first cut that it comes to; the place that it begins at is none.
void end_at_cut(const FrameArcs& frame, std::vector<std::uint32_t>& way, const ArcCuts& cuts) {
  const auto& of_arc = cuts[frame.arc_of[way.front()]];
  for (std::size_t k = 1; k < way.size() && !of_arc.empty(); ++k) {
    const std::uint32_t i = frame.index_of[way[k - 1]], j = frame.index_of[way[k]];
    const std::uint32_t between = j == i + 1 || (i > j && i != j + 1) ? i : j;
    if (std::binary_search(of_arc.begin(), of_arc.end(), between)) way.resize(k);
  }
}

/// Returns the direction in which a way comes out of its curve.
Point direction_out(const FrameArcs& frame, std::span<const std::uint32_t> way, Point joint) {
  std::vector<Point> points;
  double walked = 0;
  for (const std::uint32_t v : way) {
    if (!points.empty()) walked += distance(points.back(), frame.at(v));
    if (walked > kTipReach) break;
    points.push_back(frame.at(v));
  }
  Point out = points.size() > 1 ? tip_direction(points) : Point{};
  if (norm(out) == 0) {
    const double theta = frame.graph->patch(way.front()).theta;
    out = {std::cos(theta), std::sin(theta)};
    if (dot(out, joint - points.front()) < 0) out = out * -1;
  }
  return out;
}

double angle(Point a, Point b) {
  const double lengths = norm(a) * norm(b);
  return lengths > 0 ? std::acos(std::clamp(dot(a, b) / lengths, -1.0, 1.0)) : 0;
}

double turn_at(const FrameArcs& frame, const JointWays& ways) {
  const Point tip_a = frame.at(ways.a.front()), tip_b = frame.at(ways.b.front());
  const Point middle = (tip_a + tip_b) * 0.5, gap = tip_b - tip_a;
  const Point out_a = direction_out(frame, ways.a, middle), out_b = direction_out(frame, ways.b, middle);
  const double turn = angle(out_a, out_b * -1);
  if (norm(gap) <= kFarTips) return turn;
  return std::max({turn, angle(out_a, gap), angle(gap, out_b * -1)});
}

double robust_sd(std::vector<double>& sizes) {
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 4);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle * kQuartileToSd;
}

struct Samples {
  std::vector<double> steps, windows, curves;

  template <class Property>
  void add_steps(const FrameArcs& frame, const Arc& arc, Property property) {
    for (std::size_t k = 2; k + 1 < arc.path.size() && steps.size() < kMostSamples; ++k)
      steps.push_back(std::abs(property(frame.graph->patch(arc.path[k])) -
                               property(frame.graph->patch(arc.path[k - 1]))));
    if (curves.size() < kMostSamples) curves.push_back(median_of(frame, arc.path, property));
  }
  template <class Property>
  void add_window(const FrameArcs& frame, const JointWays& ways, Property property) {
    windows.push_back(std::abs(median_of(frame, telling(frame, ways.a), property) -
                               median_of(frame, telling(frame, ways.b), property)));
  }
  Spread spread() {
    Spread result;
    result.step = std::max(kLeastSpread, robust_sd(steps) / std::numbers::sqrt2);
    const double window = robust_sd(windows);
    constexpr double kPatches = 0.5;  // 1 / n of both sides: four patches each
    result.along = std::sqrt(std::max(0.0, window * window - kPatches * result.step * result.step));
    result.along = std::max(kLeastSpread, result.along);
    if (curves.empty()) return result;
    std::nth_element(curves.begin(), curves.begin() + static_cast<std::ptrdiff_t>(curves.size() / 2),
                     curves.end());
    const double middle = curves[curves.size() / 2];
    for (double& value : curves) value = std::abs(value - middle);
    result.between = robust_sd(curves);
    return result;
  }
};

}  // namespace

JointWays ways_from(const FrameArcs& frame, const JointSite& site, double reach) {
  if (site.at_knot()) {
    const auto& arms = frame.knots[site.knot].arms;
    return {frame.way(arms[site.arm_a], reach), frame.way(arms[site.arm_b], reach)};
  }
  const auto n = static_cast<std::uint32_t>(frame.arcs[site.arc].path.size());
  return {frame.way(site.arc, site.index, false, reach),
          frame.way(site.arc, (site.index + 1) % n, true, reach)};
}

JointScales measure_scales(std::span<const FrameArcs> frames) {
  Samples contrast, width;
  std::vector<double> turns;
  for (const FrameArcs& frame : frames) {
    for (std::uint32_t a = 0; a < frame.arcs.size(); ++a) {
      const Arc& arc = frame.arcs[a];
      contrast.add_steps(frame, arc, log_contrast);
      width.add_steps(frame, arc, log_width);
      for (std::uint32_t k = 3; k + 4 < arc.path.size() && turns.size() < kMostSamples; k += 3) {
        const auto ways = ways_from(frame, {.arc = a, .index = k}, kReach);
        contrast.add_window(frame, ways, log_contrast);
        width.add_window(frame, ways, log_width);
        turns.push_back(turn_at(frame, ways));
      }
    }
  }
  return {contrast.spread(), width.spread(), std::max(kLeastTurn, robust_sd(turns))};
}

JointLook look_at_joint(const FrameArcs& frame, const JointSite& site, const ArcCuts& cuts) {
  auto ways = ways_from(frame, site, kReach);
  end_at_cut(frame, ways.a, cuts);
  end_at_cut(frame, ways.b, cuts);
  const auto a = telling(frame, ways.a), b = telling(frame, ways.b);
  JointLook look;
  look.other_kind = !same_kind(frame.graph->patch(ways.a.front()), frame.graph->patch(ways.b.front()));
  look.stronger = median_of(frame, a, log_contrast) - median_of(frame, b, log_contrast);
  look.wider = median_of(frame, a, log_width) - median_of(frame, b, log_width);
  look.patches = 1.0 / static_cast<double>(a.size()) + 1.0 / static_cast<double>(b.size());
  look.turn = turn_at(frame, ways);
  return look;
}

JointEvidence joint_evidence(const JointLook& look, const JointScales& scales) {
  if (look.other_kind) return {kOtherKind, 0};
  const double uniform = -std::log(std::numbers::pi);
  const double half_normal = log_normal(look.turn, scales.turn) + 0.5 * std::log(2 / std::numbers::pi);
  // Where two lines blend the width is off, and with it the contrast.
  const double doubt = std::abs(look.wider);
  return {difference_evidence(look.stronger, look.patches, scales.contrast, doubt, kOutliersOfTwo) +
              difference_evidence(look.wider, look.patches, scales.width, 0, kOutliers),
          log_sum(std::log(1 - kCorners) + half_normal, std::log(kCorners) + uniform) - uniform};
}

}  // namespace emberfold::graph::detail
