// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "graph/attribute_graph.hpp"
#include "graph/matching/assignment.hpp"

namespace emberfold::graph::detail {

/// Pairs (vertex before, vertex after), by index.
using IndexLinks = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Finds one-to-one links by aligning pairs of curves in order (local alignment, Smith & Waterman 1981).
/// Either direction is tried, ends are free, and a skipped point has a cost. The pair of the greatest gain is
/// aligned first; the rest of both curves may be aligned with others. Vertices that fit no alignment stay
/// unlinked. A candidate's row is a vertex before, its column one after. O(candidates · log), times the
/// number of pieces that a curve falls into.
class Aligner {
 public:
  Aligner(const std::vector<Curve>& before, const std::vector<Curve>& after, std::size_t size_before,
          std::size_t size_after);

  /// Aligns the curves. `like(a, b)`: similarity of curves a and b, 0…1, which favours similar pairs.
  template <class Like>
  IndexLinks align(const std::vector<Candidate>& candidates, Like like) {
    collect(candidates);
    for (Pair& pair : pairs_) pair.weight = 0.5 + 0.5 * like(pair.curve_before, pair.curve_after);
    return align_greedily();
  }

 private:
  struct Cell {
    std::uint32_t i = 0, j = 0;  ///< places on both curves
    double gain = 0;
  };
  struct Pair {
    std::uint32_t curve_before = 0, curve_after = 0;
    double weight = 1;
    std::vector<Cell> cells;  ///< sorted by (i, j)
  };
  struct Alignment {
    double gain = 0;
    IndexLinks links;
  };

  void collect(const std::vector<Candidate>& candidates);
  IndexLinks align_greedily();
  [[nodiscard]] Alignment best_alignment(const Pair& pair) const;
  [[nodiscard]] Alignment best_alignment(const Pair& pair, bool backwards) const;

  const std::vector<Curve>&before_, &after_;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> places_before_, places_after_;
  std::vector<bool> used_before_, used_after_;
  std::vector<Pair> pairs_;
};

}  // namespace emberfold::graph::detail
