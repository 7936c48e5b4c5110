// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/curve_features.hpp"

#include <algorithm>
#include <cmath>

namespace emberfold::graph::detail {

namespace {

// Spreads of a curve's features from frame to frame.
constexpr double kSdCount = 0.5;         // of the logarithm of its number of patches
constexpr double kSdShape = 3;           // px
constexpr double kSdMeanContrast = 0.5;  // of the logarithm
constexpr double kSdDegree = 1;

/// Returns points at equal steps of arc length from end to end of the curve, less their mean.
std::array<Point, 5> resample(std::span<const Point> at, const Curve& curve) {
  std::array<Point, 5> result;
  double length = 0;
  for (std::size_t k = 1; k < curve.size(); ++k) length += distance(at[curve[k - 1]], at[curve[k]]);
  std::size_t k = 0;
  double walked = 0;  // up to curve[k]
  Point mean;
  for (std::size_t s = 0; s < result.size(); ++s) {
    const double wanted = length * static_cast<double>(s) / static_cast<double>(result.size() - 1);
    double step = 0;
    while (k + 1 < curve.size()) {
      step = distance(at[curve[k]], at[curve[k + 1]]);
      if (walked + step >= wanted) break;
      walked += step;
      ++k;
    }
    result[s] = at[curve[k]];
    if (k + 1 < curve.size() && step > 0) {
      result[s] = result[s] + (at[curve[k + 1]] - at[curve[k]]) * ((wanted - walked) / step);
    }
    mean = mean + result[s] * (1.0 / static_cast<double>(result.size()));
  }
  for (Point& point : result) point = point - mean;
  return result;
}

double square(double x) {
  return x * x;
}

}  // namespace

CurveFeatures compute_features(const AttributeGraph& graph, std::span<const Point> at, const Curve& curve) {
  CurveFeatures result;
  result.log_count = std::log(static_cast<double>(curve.size()));
  result.shape = resample(at, curve);
  double contrast = 0;
  for (const std::uint32_t v : curve) contrast += std::abs(graph.patch(v).contrast);
  result.log_contrast = std::log(1 + contrast / static_cast<double>(curve.size()));
  const auto others = [&](std::uint32_t end) {
    const std::size_t degree = graph.degree(end);
    return degree > 2 ? static_cast<double>(degree - 1) : 0.0;
  };
  result.degree = others(curve.front()) + others(curve.back());
  return result;
}

double similarity(const CurveFeatures& a, const CurveFeatures& b) {
  double same_way = 0, other_way = 0;
  const std::size_t n = a.shape.size();
  for (std::size_t k = 0; k < n; ++k) {
    same_way += square(distance(a.shape[k], b.shape[k]));
    other_way += square(distance(a.shape[k], b.shape[n - 1 - k]));
  }
  const double shape = std::min(same_way, other_way) / static_cast<double>(n);
  return std::exp(-0.5 * (square((a.log_count - b.log_count) / kSdCount) + shape / square(kSdShape) +
                          square((a.log_contrast - b.log_contrast) / kSdMeanContrast) +
                          square((a.degree - b.degree) / kSdDegree)));
}

}  // namespace emberfold::graph::detail
