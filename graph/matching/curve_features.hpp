// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "graph/matching/match.hpp"

namespace emberfold::graph::detail {

/// A curve as the coarse match sees it (Wang & Zhu 2004, §3.2): c, s, a, d.
struct CurveFeatures {
  double log_count = 0;          ///< of its control points
  std::array<Point, 5> shape{};  ///< points at equal steps of arc length, about their mean
  double log_contrast = 0;       ///< of the mean contrast
  double degree = 0;             ///< how many other curves it meets at its ends
};
/// `at`: where each vertex of the graph is expected.
CurveFeatures features(const AttributeGraph& graph, std::span<const Point> at, const Curve& curve);

/// P_match without its 1/Z: 1 for curves alike in all four, in either direction; towards 0 for others.
double likeness(const CurveFeatures& a, const CurveFeatures& b, const MatchOptions& options);

}  // namespace emberfold::graph::detail
