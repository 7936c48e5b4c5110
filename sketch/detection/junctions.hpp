// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds a place on a curve that belongs to a junction, or to a meeting of two ends.
struct Contact {
  std::size_t chain = 0;
  std::size_t point = 0;
};

/// Holds curves and their meetings: each meeting is a list of at least two contacts.
struct CurveNetwork {
  std::vector<Chain> chains;
  std::vector<std::vector<Contact>> meetings;
};

/// Joins free ends to the curves that they point at, nearest first. An end joins another curve of its kind,
/// or its end, no farther than 3σ + 8 px, where the way there shows half of the end's contrast or more
/// throughout: a line's brightness, a step's difference between its sides. A line goes on at 0.3 of the
/// contrast too, where its creaseness shows all along. O(points · log).
CurveNetwork join_free_ends(std::vector<Chain> chains, const ScaleSpace& space);

/// Removes curves that are too short to be distinguished from noise. Lengths are shares of the least length
/// of a curve, in px, which `least` returns. Spurs (one end free) shorter than that go, and so do connected
/// parts that are shorter in all. Repeats until nothing more is removed.
CurveNetwork prune_short_curves(CurveNetwork network, const std::function<double(const Chain&)>& least);

}  // namespace emberfold::sketch
