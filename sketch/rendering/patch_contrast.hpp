// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/patch.hpp"

namespace emberfold::sketch {

/// Raises a patch's contrast: a line's core gets farther from its sides, a step's sides from each other.
inline void raise_contrast(graph::Patch& patch, float gain) {
  for (std::size_t c = 0; c < patch.middle.size(); ++c) {
    const float mean = (patch.left[c] + patch.right[c]) / 2;
    for (auto* level : {&patch.left, &patch.right, &patch.middle})
      if (graph::on_step(patch) != (level == &patch.middle)) (*level)[c] = mean + gain * ((*level)[c] - mean);
  }
}

}  // namespace emberfold::sketch
