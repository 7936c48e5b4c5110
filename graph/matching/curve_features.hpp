// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "graph/matching/match.hpp"

namespace emberfold::graph::detail {

/// The features c, s, a, d of a curve for the coarse match (Wang & Zhu 2004, §3.2).
struct CurveFeatures {
  double log_count = 0;          ///< of the number of its control points
  std::array<Point, 5> shape{};  ///< points at equal steps of arc length, about their mean
  double log_contrast = 0;       ///< of the mean contrast
  double degree = 0;             ///< number of other curves at its ends
};
/// Computes the features of a curve. `at`: expected position of each vertex of the graph, px. O(curve).
CurveFeatures compute_features(const AttributeGraph& graph, std::span<const Point> at, const Curve& curve);

/// Returns P_match without its 1/Z (Wang & Zhu 2004, §3.2), in (0, 1].
/// 1: equal in all four features, in either direction.
double similarity(const CurveFeatures& a, const CurveFeatures& b);

}  // namespace emberfold::graph::detail
