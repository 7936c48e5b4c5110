// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace emberfold::mcmc {

/// Holds what the images show of an event's patches, frame by frame.
struct ChangeSeries {
  /// By frame, how strongly the patches show: about 1 where they are there, about 0 where not, after division
  /// by `level`.
  std::vector<double> amplitude;
  double level = 1;   ///< > 0: the amplitude where they are there
  double weight = 1;  ///< > 0: number of independent measurements in one amplitude
  /// Index of the first frame after the change as it was read from the graphs, 1…size − 1.
  std::size_t at = 1;
  bool appears = true;  ///< they are there from `at` on; else before it
  /// Frames next to the change in which their absence counts where they should be there; beyond, only
  /// presence counts, since they are lost from view when what they joined moves on.
  std::size_t followed = 0;  ///< 0: in all frames
};

/// Returns the logarithm of the Bayes factor of a change near the one read from the graphs against none.
///
/// The patches are on or off in every frame, a two-state Markov chain. An amplitude is normal about 1 or 0,
/// or, once in 20 times, anything. Compared are the posterior odds of a change in the right sense within 2
/// frames of `at` and the prior odds of it; forward and backward sums are exact (Baum, Petrie, Soules & Weiss
/// 1970). At most ±40/3 nats. Throws core::InputError for an amplitude that is not finite or an `at` out of
/// range. O(frames).
double log_change_factor(const ChangeSeries& series);

/// Estimates the share π of true changes among all that were read from a clip, from their factors.
/// π maximises the posterior of all of them under a Beta(2, 2) prior (EM), each factor at most e^±4; so a
/// clip in which nothing happens has few, and one full of events has many. O(changes · iterations).
double estimate_change_share(std::span<const double> log_factors);

/// Computes the probability of each change of a clip, from its factor and the share of true ones.
/// Errors of the measurements are not independent from frame to frame, so that here a factor counts to the
/// power 0.3. O(changes · iterations).
std::vector<double> change_probabilities(std::span<const double> log_factors);

}  // namespace emberfold::mcmc
