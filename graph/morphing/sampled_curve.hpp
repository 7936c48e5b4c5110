// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph::detail {

/// Kind of most patches of a curve. Only curves of one kind move into each other.
enum class CurveKind : std::uint8_t { bright, dark, step };

/// A curve as patches in the order in which it is walked.
/// Every patch points along the walk: others were turned round, their sides exchanged. A step is walked with
/// its brighter side to the right. A ring repeats its first patch at the end.
struct SampledCurve {
  std::vector<Patch> patches;
  std::vector<std::uint32_t> vertices;  ///< index in the graph of each patch, or of the nearest one
  std::vector<double> at;               ///< place of each patch, as a share of the length, 0…1
  Point centre;                         ///< px, mean over the length
  double length = 0;                    ///< px; of a single patch the 5 px that are drawn of it
  CurveKind kind = CurveKind::bright;
  bool closed = false;

  [[nodiscard]] std::size_t size() const { return patches.size(); }
};

/// Reads a curve of a graph.
SampledCurve sample_curve(const AttributeGraph& graph, const Curve& curve);

/// Returns the curve walked the other way.
SampledCurve reverse_curve(const SampledCurve& curve);

/// Returns a ring that begins at another of its patches. `first`: below size() − 1.
SampledCurve begin_at(const SampledCurve& ring, std::size_t first);

/// Returns the curve's patches at other places, linear between its own. `at`: ascending, 0…1.
SampledCurve resample(const SampledCurve& curve, std::span<const double> at);

}  // namespace emberfold::graph::detail
