// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "pipeline/carried/seen_clip.hpp"

namespace emberfold::pipeline {

/// Holds the strokes of a clip in families: a stroke with all that it parts into and all that it joins.
struct StrokeFamilies {
  std::vector<StrokeLife> lives;  ///< of each family, by first frame; patches of all its strokes
  std::map<graph::SubgraphId, std::size_t> of_stroke;  ///< index in `lives`; without those left out
};

/// Finds the families of at least three frames: links lead from one stroke of a family to another.
/// O(patches log strokes).
StrokeFamilies stroke_families(const SeenClip& clip);

}  // namespace emberfold::pipeline
