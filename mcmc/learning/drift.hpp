// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/model/rate_maps.hpp"

namespace emberfold::mcmc {

/// Holds the mean velocity of the curves by place, px a frame.
struct Drift {
  CellMap x, y;
  [[nodiscard]] graph::Point at(graph::Point p) const { return {x.at(p), y.at(p)}; }
};

/// Estimates the drift on the cells of `grid` from the tracks' mean speeds.
/// It is the velocity whose components along the tracks' normals fit these best: least squares, weighted by
/// nearness and by the precision of a track of its length. With few observations the estimate shrinks towards
/// the frame's mean, and that towards 0. O(samples + cells).
Drift estimate_drift(const std::vector<detail::CurveTrack>& tracks, const CellMap& grid);

/// Returns a track's displacement along its normals in each frame, less what the drift has added. O(samples).
std::vector<double> without_drift(const detail::CurveTrack& track, const CellMap& drift_x,
                                  const CellMap& drift_y);

}  // namespace emberfold::mcmc
