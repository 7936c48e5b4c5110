// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dytex/linear_dynamic_texture.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::pipeline {

/// Returns how many of a model's numbers are needed to draw from it.
/// Counts, of strokes, positions, appearance and edges of the first frame and the exemplars, the maps, the
/// distributions and the rates; of a texture: mean, C, A and B.
double parameter_count(const mcmc::MotionModel& model);
double parameter_count(const graph::SketchSequence& sketch);  ///< of strokes in every frame
double parameter_count(const dytex::LinearDynamicTexture& texture);

}  // namespace emberfold::pipeline
