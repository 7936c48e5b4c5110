// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Returns the luma of the brightest patch of a clip, 0…255; 0 without patches. O(patches).
double brightest_patch(const graph::SketchSequence& sketch);

/// Returns a patch's visible contrast, in grey levels of a mid tone, ≥ 0.
/// A screen shows a level v as the luminance (v / white)^2.2, plus a hundredth of white for reflected light;
/// lightness is the luminance to the power 1/2.2. So a contrast counts in full from a fifth of white upwards,
/// and less near black: half at a twelfth of white. `white`: luma of the clip's brightest parts, > 0.
double visible_contrast(const graph::Patch& patch, double white);

}  // namespace emberfold::pipeline
