// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/patch.hpp"
#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

/// Measures by how much the level lines around a place turn. MLSEC-ST of López, Lumbreras, Serrat &
/// Villanueva 1999: the divergence of the gradient's direction as the structure tensor has it (its dominant
/// eigenvector, turned along the gradient). It continues where a Hessian's ridge breaks: at saddles and
/// junctions. In [−2, 2], 1/px; > 0 on ridges, < 0 in valleys; 1/r on the slope around a hill, at distance r.
///
/// The divergence is multiplied by the confidence 1 − exp(−((λ₁ − λ₂)/c)²/2), which is 0 where no direction
/// is dominant. λ₁ ≥ λ₂ are the tensor's eigenvalues at the place's four neighbours, whose mean confidence
/// counts; c = `flat`², `flat` being a slope in levels per px. The place is clamped to the frame. Some 200
/// gradients.
double creaseness(const ScaleLevel& level, graph::Point p, double flat);

}  // namespace emberfold::sketch
