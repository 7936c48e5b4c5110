// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sketch/refinement/coding_length.hpp"
#include "sketch/refinement/editable_graph.hpp"

namespace emberfold::sketch {

/// Returns the nats by which an edit changes the code of the frame as it is drawn:
///   Σ (errors² after − before) / (2 noise² noise_correlation) + costs of patches and degrees, after − before
/// over the pixels that either drawing shows. What one of them leaves open there is filled from beside; the
/// rest of the frame is given. Unlike the sum of gains, it counts pixels of patches that lie close together
/// once. Patches carry their costs. O(patches + pixels about the edit); some milliseconds.
double drawing_cost_change(const EditableGraph& draft, const GraphEdit& edit, const CodingContext& luma);

}  // namespace emberfold::sketch
