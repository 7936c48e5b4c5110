// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace emberfold::mcmc::detail {

/// A deviation followed through time, off by an unknown constant, its rest.
struct Path {
  std::vector<double> own;     ///< of each frame
  std::vector<double> around;  ///< the mean over its neighbours, frame by frame; its own where it has none
};

/// d(t+1) = a1 d(t) + a2 d(t−1) + coupling (n̄(t) − d(t)) + e, of N(0, noise²), seen at d + rest with an error
/// of N(0, measurement²). Paths differ: in how far they swing, noise and measurement alike (noise² follows an
/// inverse Gamma law of four degrees of freedom, so that few paths gone astray have little say), and in how
/// fast: where the roots are complex, the frequency's SD between paths is `spread` of itself.
struct SwayLaw {
  double a1 = 0, a2 = 0, coupling = 0;
  double noise = 0, measurement = 0;  ///< SD, of a usual path
  double spread = 0;                  ///< 0 … most_spread

  /// a1, the mean over paths.
  [[nodiscard]] double mean_a1() const;
};
constexpr double most_spread = 1.0 / 3;
constexpr double most_stable = 0.995;  ///< spectral radius up to which laws are looked for

/// log p(paths | law) with each path's rest integrated out under a flat prior, its noise under the inverse
/// Gamma law and its frequency by quadrature, up to what the paths' lengths alone make of it; −∞ where the
/// law is not stable. Paths of one frame say nothing. The same bits at any thread count. O(frames of all
/// paths).
double log_likelihood(const std::vector<Path>& paths, const SwayLaw& law);

/// The law of the greatest likelihood (Nelder–Mead, from several starts on a part of the paths, then from the
/// best on all; at most some 30,000 frames of paths, evenly taken, are looked at). `deviation`: SD of the
/// paths about their means, > 0.
SwayLaw likeliest(const std::vector<Path>& paths, double coupling, double deviation);

}  // namespace emberfold::mcmc::detail
