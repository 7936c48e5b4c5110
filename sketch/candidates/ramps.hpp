// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace emberfold::sketch {

/// Holds the least-squares sums of levels over signed distances from a curve.
struct RampSums {
  double n = 0, i = 0, ii = 0, v = 0, vv = 0, vi = 0;

  /// Adds a pixel of this level at this distance.
  void add(double level, double across) {
    n += 1, i += level, ii += level * level, v += across, vv += across * across, vi += across * level;
  }
  /// Adds the sums of other pixels.
  void add(const RampSums& o) { n += o.n, i += o.i, ii += o.ii, v += o.v, vv += o.vv, vi += o.vi; }
  /// Returns the sum of squares about the best even ramp.
  [[nodiscard]] double residual() const;
};

/// Holds ramps over the pixels of a section that lie between those that others explain.
class Ramps {
 public:
  /// Forgets all pixels; bins lie side by side across the curve.
  void reset(std::size_t bins) { own_.assign(bins, {}), others_.assign(bins, 0); }
  /// Adds a pixel that nothing else explains.
  void add(int bin, double level, double across) { own_[static_cast<std::size_t>(bin)].add(level, across); }
  /// Adds one that something else explains; where these are more, a ramp ends.
  void add_other(int bin) { others_[static_cast<std::size_t>(bin)] += 1; }
  /// Returns the sum of squares about the best ramp between each two ends.
  [[nodiscard]] double residual() const;

 private:
  std::vector<RampSums> own_;
  std::vector<double> others_;
};

}  // namespace emberfold::sketch
