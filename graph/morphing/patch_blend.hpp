// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/patch.hpp"

namespace emberfold::graph::detail {

/// Returns an angle in (−π, π].
double wrap_angle(double angle);

/// Returns the same patch with the opposite direction: its sides are exchanged.
Patch turn_round(Patch patch);

/// Returns the patch at a share (0…1) of the way from one to another, with the type of the nearer one and the
/// direction of `a` plus `turn` times the share, rad.
Patch blend_patches(const Patch& a, const Patch& b, double share, double turn);

/// Returns a patch between two neighbours on a curve; strictly between them it is a plain line or step.
Patch patch_between(const Patch& a, const Patch& b, double share);

}  // namespace emberfold::graph::detail
