// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sketch/candidates/ramps.hpp"

namespace emberfold::sketch {

/// Holds a blurred step or bar, tabulated at evenly spaced distances from its curve.
struct TrialShape {
  double width = 0, blur = 1;        ///< px; width 0: a step
  double reach = 0;                  ///< px to each side over which it is compared with the image
  int bins = 0;                      ///< of these, to each side of the middle one
  std::vector<float> first, second;  ///< 0…1 at each bin: right of the left edge, right of the right edge

  /// Returns the distance within which the profile changes, px.
  [[nodiscard]] double core() const { return 0.5 * width + 2 * blur + 1; }
};

/// Holds the shapes that are tried on curves of one scale.
struct TrialShapes {
  double bin = 0.5;  ///< px
  int half = 0;      ///< bins to each side of the middle one
  std::vector<TrialShape> steps, bars;

  /// Returns the number of bins.
  [[nodiscard]] std::size_t bins() const { return 2 * static_cast<std::size_t>(half) + 1; }
  /// Returns the index of the bin at this distance, which is at most reach(), in size.
  [[nodiscard]] int bin_at(double across) const;
  /// Returns the greatest distance that has a bin, px.
  [[nodiscard]] double reach() const { return half * bin; }
};

/// Tabulates the shapes of curves that respond best at scale `sigma`, px. A step seen there has about this
/// blur (Lindeberg 1998, eq. 31), a bar of width w and blur b has about w²/12 + b² = sigma².
TrialShapes make_trial_shapes(double sigma);

/// Holds the levels of a profile fitted to pixels; residual < 0: none of the wanted sign fits.
struct TrialLevels {
  double residual = -1, left = 0, middle = 0, right = 0;
};

/// Fits a step that rises to the right. `bins`: sums per bin; `all`: those of the shape's bins.
TrialLevels fit_step(const TrialShape& shape, std::span<const RampSums> bins, const RampSums& all);
/// Fits a bar that is brighter (sign 1) or darker (−1) than both of its sides.
TrialLevels fit_bar(const TrialShape& shape, std::span<const RampSums> bins, const RampSums& all,
                    double sign);

}  // namespace emberfold::sketch
