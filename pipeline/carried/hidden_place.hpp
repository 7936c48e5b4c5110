// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pipeline/carried/seen_clip.hpp"

namespace emberfold::pipeline {

/// Border over which hiding pixels blend into the frame, px: other strokes next to it stay.
constexpr double kHidingFeather = 3;

/// Source of the pixels that are shown instead of a stroke.
struct HiddenPlace {
  graph::Point beside;  ///< px, from the stroke's place
  int later = 0;        ///< frames, from the frame that is shown
  double misfit = 0;    ///< grey levels: difference of the surroundings, and the cost of strokes there

  /// Returns the number of the frame shown instead of frame t, of a clip of `size` frames played to and fro.
  [[nodiscard]] int frame(int t, int size) const;
};

/// Finds pixels that hide patches of frame t.
/// Candidates are places next to the patches, and the same place at other times; chosen is one without
/// strokes, now and some frames later, that looks like the patches' surroundings.
HiddenPlace find_hidden_place(const SeenClip& clip, int t, std::span<const graph::Patch> patches);

/// Returns whether strokes are at the source of the pixels that hide patches of frame t, at a quarter of
/// them.
bool shows_strokes(const SeenClip& clip, int t, std::span<const graph::Patch> patches,
                   const HiddenPlace& place);

/// Returns how much two places differ around a patch, grey levels: `at` in frame t, and the place displaced
/// by `beside` (px) in frame `other`.
double unlikeness_around(const SeenClip& clip, const graph::Patch& patch, graph::Point at, int t,
                         graph::Point beside, int other);

}  // namespace emberfold::pipeline
