// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// A place on a curve that belongs to a junction (or to the meeting of two ends).
struct Contact {
  std::size_t chain = 0;
  std::size_t point = 0;
};

/// Curves and where they meet: each meeting is a list of at least two contacts.
struct CurveNetwork {
  std::vector<Chain> chains;
  std::vector<std::vector<Contact>> meetings;
};

/// Lets free ends meet what they point at: another curve of the same kind, or its end, no farther than 3σ + 8
/// px, when the way there shows at half of the end's contrast or more throughout: a line's brightness, a
/// step's difference between its sides. A line goes on at 0.3 of the contrast too, where its creaseness shows
/// all along. Nearest first.
CurveNetwork join_free_ends(std::vector<Chain> chains, const ScaleSpace& space);

/// Drops what is too short to tell from noise: spurs (one end free) below `min_length` px that hang on
/// another curve, and whatever hangs together and is shorter than that in all. Repeats until nothing goes.
CurveNetwork prune_short_curves(CurveNetwork network, double min_length);

}  // namespace emberfold::sketch
