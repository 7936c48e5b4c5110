// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc::detail {

/// Holds one attribute of a clip's curve tracks, and the law that it follows.
struct FollowedAttribute {
  std::vector<std::vector<double>> values;  ///< of each track, as long as its samples
  std::vector<double> scales;               ///< of each track: factor of the law's noise
  bool turns_with_normal = false;           ///< its sign depends on the sense of the normal
  double least_error = 0;                   ///< SD, > 0: of a measured value at least
};

/// Returns the displacement of the tracks across their curves, less the model's drift, px.
FollowedAttribute followed_displacement(const std::vector<CurveTrack>& tracks, const MotionModel& model);
/// Returns the logarithm of their contrast over the share that it has at their age.
FollowedAttribute followed_contrast(const std::vector<CurveTrack>& tracks, const MotionModel& model);

/// Adds up, gap by gap, the log-density of each track's next value given all before. The tracks' rests are
/// unknown, under a flat prior, so a track's first value has none. The coupling acts on the deviations that
/// are expected given the past. Element t − 1 is the gap before frame t. O(samples).
std::vector<double> path_log_densities(const std::vector<CurveTrack>& tracks,
                                       const TrackNeighbours& neighbours, const FollowedAttribute& attribute,
                                       const Autoregression& law, std::size_t frames);

}  // namespace emberfold::mcmc::detail
