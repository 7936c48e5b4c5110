// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/sampled_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "graph/morphing/patch_blend.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr double kSinglePatch = 5;  // px that are drawn of a patch without edges

CurveKind kind_of(const std::vector<Patch>& patches) {
  std::array<std::size_t, 3> count{};
  for (const Patch& patch : patches) {
    const CurveKind kind = on_step(patch)        ? CurveKind::step
                           : patch.contrast >= 0 ? CurveKind::bright
                                                 : CurveKind::dark;
    ++count[static_cast<std::size_t>(kind)];
  }
  return static_cast<CurveKind>(std::ranges::max_element(count) - count.begin());
}

// Turns a patch round where it points against the walk.
void point_along(SampledCurve& curve) {
  const std::size_t n = curve.size();
  for (std::size_t i = 0; n > 1 && i < n; ++i) {
    const Point ahead = curve.patches[std::min(i + 1, n - 1)].position;
    const Point behind = curve.patches[i > 0 ? i - 1 : 0].position;
    Patch& patch = curve.patches[i];
    if (dot(ahead - behind, {std::cos(patch.theta), std::sin(patch.theta)}) < 0) patch = turn_round(patch);
  }
}

void measure(SampledCurve& curve) {
  const std::size_t n = curve.size();
  curve.at.assign(n, 0);
  Point sum;
  double length = 0;
  for (std::size_t i = 1; i < n; ++i) {
    const Point a = curve.patches[i - 1].position, b = curve.patches[i].position;
    const double step = distance(a, b);
    sum = sum + (a + b) * (0.5 * step);
    curve.at[i] = length += step;
  }
  if (length > 0) {
    for (double& at : curve.at) at /= length;
    curve.centre = sum * (1 / length);
  } else {
    for (std::size_t i = 1; i < n; ++i) curve.at[i] = static_cast<double>(i) / static_cast<double>(n - 1);
    curve.centre = curve.patches.front().position;
  }
  curve.length = std::max(length, n == 1 ? kSinglePatch : 1.0);
}

bool shows_brighter_left(const SampledCurve& curve) {
  double contrast = 0;
  for (const Patch& patch : curve.patches) contrast += on_step(patch) ? patch.contrast : 0;
  return contrast < 0;
}

}  // namespace

SampledCurve sample_curve(const AttributeGraph& graph, const Curve& curve) {
  SampledCurve result;
  for (const std::uint32_t v : curve) {
    result.patches.push_back(graph.patch(v));
    result.vertices.push_back(v);
  }
  result.closed = curve.size() > 1 && curve.front() == curve.back();
  result.kind = kind_of(result.patches);
  point_along(result);
  measure(result);
  if (result.kind == CurveKind::step && shows_brighter_left(result)) return reverse_curve(result);
  return result;
}

SampledCurve reverse_curve(const SampledCurve& curve) {
  SampledCurve result = curve;
  std::reverse(result.patches.begin(), result.patches.end());
  std::reverse(result.vertices.begin(), result.vertices.end());
  for (Patch& patch : result.patches) patch = turn_round(patch);
  measure(result);
  return result;
}

SampledCurve begin_at(const SampledCurve& ring, std::size_t first) {
  SampledCurve result = ring;
  const auto turn = [first](auto& values) {
    values.pop_back();
    std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
    values.push_back(values.front());
  };
  turn(result.patches);
  turn(result.vertices);
  measure(result);
  return result;
}

SampledCurve resample(const SampledCurve& curve, std::span<const double> at) {
  SampledCurve result = curve;
  result.at.assign(at.begin(), at.end());
  result.patches.clear(), result.vertices.clear();
  std::size_t i = 0;
  for (const double place : at) {
    while (i + 2 < curve.size() && curve.at[i + 1] < place) ++i;
    const std::size_t next = std::min(i + 1, curve.size() - 1);
    const double step = curve.at[next] - curve.at[i];
    const double share = step > 0 ? std::clamp((place - curve.at[i]) / step, 0.0, 1.0) : 0;
    result.patches.push_back(patch_between(curve.patches[i], curve.patches[next], share));
    result.vertices.push_back(curve.vertices[share < 0.5 ? i : next]);
  }
  return result;
}

}  // namespace emberfold::graph::detail
