// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"
#include "pipeline/figures/figure_regions.hpp"

namespace emberfold::pipeline {

/// Says which regions are figures, by family: all that links join, directly or not, at threshold 0. Figures
/// are wider than a line, or small and compact; or they have sharp edges and `lines`, the clip's sketch, do
/// not draw them. What lies between lines of the other polarity, or dark between light figures, is their
/// ground, and none. At the other thresholds figures are what shares pixels with these.
void find_families(FigureRegions& all, const FigureGround& ground, const graph::SketchSequence& lines);

}  // namespace emberfold::pipeline
