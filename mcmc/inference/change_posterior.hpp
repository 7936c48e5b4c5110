// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace emberfold::mcmc {

/// Holds what the images show of an event's patches, frame by frame.
struct ChangeSeries {
  /// By frame, how strongly the patches show: about 1 where they are there, about 0 where not, after division
  /// by `level`.
  std::vector<double> amplitude;
  /// By frame, the share of the patches that are within the picture, 0…1: the others tell nothing. Empty:
  /// all.
  std::vector<double> in_view;
  double level = 1;   ///< > 0: the amplitude where they are there
  double weight = 1;  ///< > 0: number of independent measurements in one amplitude
  /// Index of the first frame after the change as it was read from the graphs, 1…size − 1.
  std::size_t at = 1;
  bool appears = true;  ///< they are there from `at` on; else before it
};

/// Largest log_change_factor(), nats.
inline constexpr double kMostChangeFactor = 40 / 3.0;

/// Returns the logarithm of the Bayes factor of a change near the one read from the graphs against none.
///
/// The patches are on or off in every frame, a two-state Markov chain. An amplitude is normal about 1 or 0,
/// or, once in 20 times, anything. Compared are the posterior odds of a change in the right sense within 2
/// frames of `at` and the prior odds of it; forward and backward sums are exact (Baum, Petrie, Soules & Weiss
/// 1970). At most ±kMostChangeFactor. Throws core::InputError for an amplitude that is not finite or an `at`
/// out of range. O(frames).
double log_change_factor(const ChangeSeries& series);

inline constexpr int kFramesUntilLong = 12;  ///< from one change to its opposite: more say nothing more

/// Holds all that speaks for one change of a clip's graphs.
struct ChangeEvidence {
  double log_factor = 0;  ///< log_change_factor() of what the images show, nats
  bool of_stroke = true;  ///< a birth or death; else a joint of two strokes opens or closes
  /// Frames to the nearest opposite change in the same place, before and after, or to the clip's end; more
  /// than kFramesUntilLong is no more than that.
  double since = 1e9, until = 1e9;
  double contrast = 255;  ///< of what changes, visible grey levels: below 16 hardly anybody sees it
};

/// Returns the log odds of a change where the usual share of those read is true.
/// A log-linear model (logistic regression) whose weights were fitted to made clips with known events and to
/// real pictures that stand still or sway (docs/method/events.md).
double change_log_odds(const ChangeEvidence& evidence);

}  // namespace emberfold::mcmc
