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

/// Estimates the drift on the cells of `grid`: the velocity whose components along the tracks' normals best fit
/// their mean speeds.
/// Least squares, weighted by nearness and by how precisely a track of its length shows a speed. Where little
/// was observed the estimate shrinks towards the frame's mean, and that towards 0. O(samples + cells).
Drift estimate_drift(const std::vector<detail::CurveTrack>& tracks, const CellMap& grid);

}  // namespace emberfold::mcmc
