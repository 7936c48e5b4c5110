// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds the thresholds of gaps.
struct ContrastGapLimits {
  double share = 0;  ///< of the usual contrast around it, below which a point is no part of the curve
  double noise = 0;  ///< grey levels, SD of the pixels
  int numbered = 0;  ///< gaps that have a number already, 1 to this
};

/// Returns the greatest number that a gap of these curves bears, 0 where none has one.
int last_gap(const std::vector<Chain>& chains);

/// Cuts curves where their contrast fades. The contrast across the curve is measured twice:
/// - at the curve's own scale: a point stays if its contrast is at least `share` of the usual one around it
///   (±20 px along the curve); dips below 3 px stay;
/// - in the frame itself, where the curve's own scale does not close a narrow gap: the contrast falls below
///   `share` of the usual one on both sides by more than noise does, and the middle falls with it (where
///   another curve crosses, only the sides rise). The two ends at such a gap bear its number (Chain::gap).
/// Pieces shorter than two points are dropped, and those of less than 6 px between two gaps. O(points).
std::vector<Chain> cut_at_contrast_gaps(const std::vector<Chain>& chains, const ScaleSpace& space,
                                        const ContrastGapLimits& limits);

/// Tells whether the frame shows a narrow gap of a curve, as cut_at_contrast_gaps() finds it there, at one of
/// the points first…last. `sigma`: px, of the curve's profile. O(points).
bool shows_gap(const Chain& chain, std::size_t first, std::size_t last, const cv::Mat1f& frame, double sigma,
               const ContrastGapLimits& limits);

/// Trims ends of curves that face each other where the frame shows a narrow gap on the way from one to the
/// other, as cut_at_contrast_gaps() finds it within a curve. Both ends then bear the gap's number. The
/// nearest ends come first, each end has one gap at most; numbers go on from those that the curves bear.
/// O(ends² + points).
std::vector<Chain> part_ends_at_gaps(std::vector<Chain> chains, const ScaleSpace& space,
                                     const ContrastGapLimits& limits);

}  // namespace emberfold::sketch
