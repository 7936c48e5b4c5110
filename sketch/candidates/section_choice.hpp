// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace emberfold::sketch {

/// Chooses the sections of a curve that gain most in sum, less `end_cost` (≥ 0) for each end of a run of
/// them. The first and last section of a closed curve are no ends; one that would be whole has to gain two
/// ends all the same, or nothing of it is chosen. Exact but for that, by dynamic programming (Viterbi 1967);
/// of equal choices it returns the one with fewer sections. O(sections).
std::vector<char> choose_sections(std::span<const double> gain, double end_cost, bool closed);

}  // namespace emberfold::sketch
