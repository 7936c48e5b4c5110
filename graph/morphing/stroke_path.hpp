// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "graph/morphing/sampled_curve.hpp"

namespace emberfold::graph::detail {

/// px: strokes fade rather than move so far.
inline constexpr double kFarthestMove = 200;

/// The shortest path from a curve to another in the space of curves (docs/method/morphing.md).
/// A curve is its middle, its length, and its direction and speed along it; in these numbers the space is
/// flat, so every one of them changes evenly.
struct StrokePath {
  SampledCurve from, to;      ///< of as many patches; each at its own places along its curve
  std::vector<double> turns;  ///< rad: by how much each piece between two patches turns
  double length = 0;          ///< px: root mean square of how far its points go
  bool closed = false;        ///< both are rings

  /// Returns the patches at a share (0…1) of the path. A ring does not repeat its first.
  [[nodiscard]] std::vector<Patch> patches(double share) const;
};

/// Finds the shortest path over both directions of a line, and over all beginnings of a ring.
/// Nothing for curves of different kinds and for paths of kFarthestMove or more. O(patches), of a ring
/// O(patches²).
std::optional<StrokePath> find_path(const SampledCurve& a, const SampledCurve& b);

}  // namespace emberfold::graph::detail
