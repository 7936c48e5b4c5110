// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/stroke_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "graph/morphing/patch_blend.hpp"

namespace emberfold::graph::detail {

namespace {

using std::numbers::pi;

double squared(double x) {
  return x * x;
}

// The direction of each piece; a single patch's own.
std::vector<double> directions(const SampledCurve& curve) {
  if (curve.size() == 1) return {curve.patches[0].theta};
  std::vector<double> result;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Point step = curve.patches[i].position - curve.patches[i - 1].position;
    result.push_back(step == Point{} ? curve.patches[i].theta : std::atan2(step.y, step.x));
  }
  return result;
}

// The share of the length that each piece has; of a single patch all.
std::vector<double> piece_shares(const SampledCurve& curve) {
  if (curve.size() == 1) return {1};
  std::vector<double> result;
  for (std::size_t i = 1; i < curve.size(); ++i) result.push_back(curve.at[i] - curve.at[i - 1]);
  return result;
}

double mean_turn(const StrokePath& path) {
  const auto a = piece_shares(path.from), b = piece_shares(path.to);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] + b[i]) / 2 * path.turns[i];
  return sum;
}

// The turns go on from piece to piece, and all together turn by less than half a turn. At just that, both
// senses are as short; the one taken is the same for the path read backwards.
void find_turns(StrokePath& path) {
  const auto a = directions(path.from), b = directions(path.to);
  double turn = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    turn += wrap_angle(b[i] - a[i] - turn);
    path.turns.push_back(turn);
  }
  constexpr double kTie = 1e-9;
  const double mean = mean_turn(path);
  double excess = mean - wrap_angle(mean);
  if (std::abs(std::abs(wrap_angle(mean)) - pi) < kTie) {
    const double half_way = a[0] + (path.turns[0] - excess) / 2;
    if (std::sin(half_way) < -kTie || (std::abs(std::sin(half_way)) <= kTie && std::cos(half_way) < 0))
      excess += std::copysign(2 * pi, mean - excess);
  }
  for (double& t : path.turns) t -= excess;
}

double look_change(const StrokePath& path) {
  constexpr double kLevelWeight = 0.1;  // px that a change by one grey level counts
  double sum = 0;
  for (std::size_t i = 0; i < path.from.size(); ++i) {
    const Patch &a = path.from.patches[i], &b = path.to.patches[i];
    double levels = 0;
    for (const auto side : {&Patch::left, &Patch::middle, &Patch::right})
      for (std::size_t c = 0; c < (a.*side).size(); ++c)
        levels += squared(double{(a.*side)[c]} - double{(b.*side)[c]});
    sum += squared(kLevelWeight) * levels / 9 + squared(a.width - b.width) + squared(a.blur - b.blur);
  }
  return sum / static_cast<double>(path.from.size());
}

double path_length(const StrokePath& path) {
  const auto a = piece_shares(path.from), b = piece_shares(path.to);
  double turning = 0;
  for (std::size_t i = 0; i < a.size(); ++i) turning += (a[i] + b[i]) / 2 * squared(path.turns[i]);
  const double stretch = std::log(path.to.length / path.from.length);
  const Point shift = path.to.centre - path.from.centre;
  // Points of a straight line of length L lie L/√12 from its middle (root mean square).
  const double reach = path.from.length * path.to.length / 12;
  return std::sqrt(dot(shift, shift) + reach * (turning + squared(stretch)) + look_change(path));
}

StrokePath join_curves(const SampledCurve& a, const SampledCurve& b) {
  StrokePath path;
  path.closed = a.closed && b.closed;
  path.from = a.size() < b.size() ? resample(a, b.at) : a;
  path.to = b.size() < a.size() ? resample(b, a.at) : b;
  find_turns(path);
  path.length = path_length(path);
  return path;
}

void keep_shorter(std::optional<StrokePath>& best, StrokePath path) {
  constexpr double kTie = 1e-9;  // equal paths: the first that is tried
  if (!best || path.length < best->length - kTie) best = std::move(path);
}

// Steps have a direction of their own, lines none.
void try_directions(std::optional<StrokePath>& best, const SampledCurve& a, const SampledCurve& b) {
  keep_shorter(best, join_curves(a, b));
  if (a.kind == CurveKind::bright || a.kind == CurveKind::dark)
    keep_shorter(best, join_curves(a, reverse_curve(b)));
}

std::vector<double> mix_numbers(const std::vector<double>& a, const std::vector<double>& b, double share) {
  std::vector<double> result;
  for (std::size_t i = 0; i < a.size(); ++i) result.push_back((1 - share) * a[i] + share * b[i]);
  return result;
}

}  // namespace

std::optional<StrokePath> find_path(const SampledCurve& a, const SampledCurve& b) {
  if (a.kind != b.kind || (a.size() == 1) != (b.size() == 1) || distance(a.centre, b.centre) >= kFarthestMove)
    return std::nullopt;
  std::optional<StrokePath> best;
  const bool turn_a = a.closed && (!b.closed || a.size() < b.size());
  if (turn_a)
    for (std::size_t k = 0; k + 1 < a.size(); ++k) try_directions(best, begin_at(a, k), b);
  else if (b.closed)
    for (std::size_t k = 0; k + 1 < b.size(); ++k) try_directions(best, a, begin_at(b, k));
  else
    try_directions(best, a, b);
  if (best->length >= kFarthestMove) return std::nullopt;
  return best;
}

std::vector<Patch> StrokePath::patches(double share) const {
  const std::size_t n = from.size();
  const double size = std::exp((1 - share) * std::log(from.length) + share * std::log(to.length));
  const auto directions_from = directions(from);
  const auto parts = mix_numbers(piece_shares(from), piece_shares(to), share);
  std::vector<Point> points(n);
  Point middle;
  for (std::size_t i = 1; i < n; ++i) {
    const double angle = directions_from[i - 1] + share * turns[i - 1];
    points[i] = points[i - 1] + Point{std::cos(angle), std::sin(angle)} * (size * parts[i - 1]);
  }
  if (closed) {
    const Point gap = points[n - 1] - points[0];
    const auto at = mix_numbers(from.at, to.at, share);
    for (std::size_t i = 0; i < n; ++i) points[i] = points[i] - gap * at[i];
  }
  for (std::size_t i = 1; i < n; ++i) middle = middle + (points[i - 1] + points[i]) * (parts[i - 1] / 2);
  const Point shift = from.centre * (1 - share) + to.centre * share - middle;
  std::vector<Patch> result;
  for (std::size_t i = 0; i < (closed ? n - 1 : n); ++i) {
    const double turn = (turns[i > 0 ? i - 1 : 0] + turns[std::min(i, turns.size() - 1)]) / 2;
    const Patch &a = from.patches[i], &b = to.patches[i];
    result.push_back(blend_patches(a, b, share, turn + wrap_angle(b.theta - a.theta - turn)));
    result.back().position = points[i] + shift;
  }
  return result;
}

}  // namespace emberfold::graph::detail
