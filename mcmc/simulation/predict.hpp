// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// For every frame the graph expected from the frames `steps` (≥ 1, else InputError) and more before it: the
/// patches of the frame `steps` before, each gone on by the model's auto-regression; nothing is born and
/// nothing dies. Where a patch's rest is, is not known but estimated from its path so far (a Kalman filter
/// over displacement and rest). Empty for the first `steps` frames. Only the model's drift and displacement are used.
/// O(vertices · steps).
std::vector<graph::AttributeGraph> predict(const MotionModel& model, const graph::MotionGraph& motion,
                                           int steps = 1);

}  // namespace emberfold::mcmc
