// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "graph/patch.hpp"

namespace emberfold::graph {

/// Farthest that patches of one place of a stroke lie from each other, px.
inline constexpr double kCoincidence = 6;

/// Returns how far two patches lie apart, along and across the stroke together, px, if both may show the same
/// place of it: of one kind, at most 4.5 px apart along it, 3 px across and 0.6 rad in direction. Junctions
/// and corners need to be 4.5 px apart at most, whatever their kind.
std::optional<double> coincidence(const Patch& patch, const Patch& other);

}  // namespace emberfold::graph
