// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/learning/drift.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Estimates, for each gap between two frames, how velocities differ from their mean over time, px a frame.
/// A smooth field (SD of 1 cell) whose components along the tracks' normals fit the tracks' steps: least
/// squares that shrink towards 0 where few tracks are. Element t is the gap after frame t. O(samples + frames
/// · cells).
std::vector<Drift> estimate_velocities(const std::vector<detail::CurveTrack>& tracks, const CellMap& grid,
                                       int frames);

/// Learns the modes of such fields: their principal components, as many as hold 95 % of the energy, at most
/// 20 and a quarter of the fields, and the first-order auto-regression of their amplitudes (a linear dynamic
/// texture, Doretto, Chiuso, Wu & Soatto 2003, by the Yule-Walker equations, so that it is stable). None for
/// fewer than eight fields. O(fields² · cells).
VelocityModes learn_velocity_modes(const std::vector<Drift>& velocities);

/// Returns the field that the modes make at these amplitudes.
Drift combine_modes(const VelocityModes& modes, const CellMap& grid, std::span<const double> amplitudes);

/// Returns the modes with the share of the steps' variance that the model's drift and sway leave over, so
/// that both together move as the tracks do; none where that is less than a tenth.
VelocityModes besides_sway(VelocityModes modes, const std::vector<detail::CurveTrack>& tracks,
                           const MotionModel& model);

/// Returns the modes of the clip played backwards: the exact reversal of the auto-regression, velocities
/// negated.
VelocityModes reverse_modes(VelocityModes modes);

}  // namespace emberfold::mcmc
