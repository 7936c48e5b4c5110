// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/figures/figure_regions.hpp"

namespace emberfold::pipeline {

/// The outlines of a clip's figures, linked in time.
struct DrawnFigures {
  graph::MotionGraph motion;                          ///< strokes identified; each is one region
  std::vector<std::vector<std::size_t>> region_of;    ///< by frame and vertex
  std::vector<std::vector<std::size_t>> polarity_of;  ///< of that region
};

/// Draws the outer outlines of a clip's figures as rings of step edges some 5 px apart.
/// Where they are cut off by the frame's or the mask's border they run along it, without contrast. Figures
/// whose outlines lie mostly there are ground, and not drawn. Patches of linked regions are linked by motion,
/// and those of each pair of linked regions at least once, so that changes of regions are changes of strokes.
/// Reads the clip once. Throws core::Cancelled.
DrawnFigures draw_figures(core::FrameSource& source, const FigureRegions& all, const FigureGround& ground,
                          const core::Context& context);

}  // namespace emberfold::pipeline
