// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// How the curves travel on average, by place, px a frame: the velocity whose parts along the lineages'
/// normals fit their mean speeds best (least squares, weighted by nearness and by how well a speed can be
/// told from a sway over the lineage's length; where little is known drawn towards the frame's mean, and that
/// towards rest).
struct Drift {
  CellMap x, y;
  [[nodiscard]] graph::Point at(graph::Point p) const { return {x.at(p), y.at(p)}; }
};
Drift measure_drift(const std::vector<detail::Lineage>& lineages, const CellMap& grid);

/// A map of zeros over a frame, of cells fit for it.
CellMap grid_over(int width, int height);

/// A map smoothed by a Gaussian of SD `sigma` cells, whole mass kept at the borders: every cell's value is
/// spread over the cells around it in shares that sum to one.
std::vector<double> spread(const CellMap& map, double sigma);

}  // namespace emberfold::mcmc
