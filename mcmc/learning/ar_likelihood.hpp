// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace emberfold::mcmc::detail {

/// Holds a deviation followed through time, up to an unknown constant (its rest).
struct DeviationPath {
  std::vector<double> own;             ///< of each frame
  std::vector<double> neighbour_mean;  ///< mean over its neighbours, frame by frame; its own without any
};

/// Holds a law of motion shared by many paths, each with its own scale and frequency.
///   d(t+1) = a1 d(t) + a2 d(t−1) + coupling (n̄(t) − d(t)) + e,  e ~ N(0, noise²)
/// A path shows d + rest with an error of N(0, measurement²). Noise and measurement of a path share one
/// scale: noise² follows an inverse Gamma law of four degrees of freedom, so outlying paths have little
/// weight. Where the roots are complex, the frequency's SD between paths is `spread` of itself.
struct MotionLaw {
  double a1 = 0, a2 = 0, coupling = 0;
  double noise = 0, measurement = 0;  ///< SD, of a typical path
  double spread = 0;                  ///< 0 … most_spread

  /// Returns the mean of a1 over paths.
  [[nodiscard]] double mean_a1() const;
};
/// Largest relative SD of the frequency: at 2.5 SDs the frequency stays above 0.
constexpr double most_spread = 1.0 / 3;
/// Largest spectral radius of a law that is searched: its deviations halve in 140 frames.
constexpr double most_stable = 0.995;

/// Returns log p(paths | law), up to a constant that depends on the paths' lengths alone.
/// Each path's rest is integrated out under a flat prior, its noise under the inverse Gamma law, its
/// frequency by quadrature. −∞ for a law that is not stable. Paths of one frame contribute 0. The same bits
/// at any thread count. O(frames of all paths).
double log_likelihood(const std::vector<DeviationPath>& paths, const MotionLaw& law);

/// Finds the law of greatest likelihood for a given coupling.
/// `deviation`: SD of the paths about their means, > 0. Nelder–Mead from several starts on a part of the
/// paths, then from the best on all; at most about 30,000 frames of paths, evenly taken, are used.
MotionLaw most_likely_law(const std::vector<DeviationPath>& paths, double coupling, double deviation);

}  // namespace emberfold::mcmc::detail
