// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Predicts each frame's graph from the frames `steps` (≥ 1) and more before it.
/// It has the patches of the frame `steps` before, each advanced by the model's auto-regression; nothing is
/// born and nothing dies. The unknown rest of a patch is estimated from its path so far (a Kalman filter over
/// displacement and rest). Only the model's drift and displacement are used. Empty for the first `steps`
/// frames. Throws core::InputError for `steps` < 1. O(vertices · steps).
std::vector<graph::AttributeGraph> predict(const MotionModel& model, const graph::MotionGraph& motion,
                                           int steps = 1);

}  // namespace emberfold::mcmc
