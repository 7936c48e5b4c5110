// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds the settings of find_weak_curves().
struct WeakCurveLimits {
  double response;  ///< SD: points below it are left out
  double contrast;  ///< grey levels, likewise
  double evidence;  ///< nats that a curve needs
  double length;    ///< px that a piece of a curve needs
  bool steps;       ///< steps too
  double of_flank;  ///< see remove_flanks()
};

/// Holds samples of the levels' second derivatives, averaged along lines, and after them of their first.
using ResponseSamples = std::vector<std::vector<float>>;
/// Adds those of a part of a frame (sample_across()); none of levels that are not looked at. As costly as
/// looking.
void add_samples(const ScaleSpace& space, const FramePart& part, bool steps, ResponseSamples& samples);
/// Returns what is usual of each, for find_weak_curves(); 0 where there are no samples.
std::vector<double> usual_responses(ResponseSamples samples);

/// Finds the lines that only their length shows: curves through the maxima of the response averaged along
/// lines (oriented_response.hpp), in SD of its local ground. A point needs both its sides: what one side of
/// the line differs from the other is taken off its response, and the slope across must nearly vanish. What
/// lies on `strong`, the curves that were found without averaging, or is what averaging smears of those
/// beyond their ends and into their gaps, is not found again. Luma's scales of 1 to 3 half octaves are used:
/// the finest adds noise, coarser ones shading. `usual`: usual_responses() of the frame of which this is a
/// part; empty: of this frame. O(pixels · scales · directions).
std::vector<Chain> find_weak_curves(const std::vector<Chain>& strong, const ScaleSpace& space, double noise,
                                    const WeakCurveLimits& limits, const std::vector<double>& usual = {});

}  // namespace emberfold::sketch
