// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

struct ContrastGapLimits {
  double share;  ///< of the contrast that is usual around it: what shows less is not the curve
  double noise;  ///< grey levels, SD of the pixels
};

/// Cuts curves where they fade. Twice measured, across the curve:
/// - at the curve's own scale: a point stays if its contrast is at least `share` of what is usual around it
///   (±20 px along the curve); dips below 3 px stay;
/// - in the frame itself, where a curve's own scale does not close it: a narrow gap is where the contrast
/// falls
///   below `share` of what is usual on both sides by more than noise does, and the middle falls with it
///   (where another curve crosses, only the sides rise). The two ends at such a gap bear its number
///   (Chain::gap).
/// Pieces shorter than two points go, and those of less than 6 px between two gaps. O(points).
std::vector<Chain> cut_at_contrast_gaps(const std::vector<Chain>& chains, const ScaleSpace& space,
                                        const ContrastGapLimits& limits);

}  // namespace emberfold::sketch
