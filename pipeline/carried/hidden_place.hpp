// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pipeline/carried/seen_clip.hpp"

namespace emberfold::pipeline {

/// Border over which what hides a stroke blends into the frame, px: other strokes beside it stay.
constexpr double kHidingFeather = 3;

/// Where the pixels come from that are shown instead of a stroke.
struct HiddenPlace {
  graph::Point beside;  ///< px, from the stroke's place
  int later = 0;        ///< frames, from the frame that is shown
  double misfit = 0;    ///< grey levels: unlike surroundings, and what strokes there count for

  /// Returns the frame that is shown instead of frame t: of a clip of `size` frames, which goes to and fro.
  [[nodiscard]] int frame(int t, int size) const;
};

/// Finds pixels that hide patches of frame t: of the places beside them and of the same place at other times
/// one where no stroke lies, now and some frames on, and that looks like what is around the patches.
HiddenPlace find_hidden_place(const SeenClip& clip, int t, std::span<const graph::Patch> patches);

/// Returns whether strokes lie where the pixels come from that hide patches of frame t: at a quarter of them.
bool shows_strokes(const SeenClip& clip, int t, std::span<const graph::Patch> patches,
                   const HiddenPlace& place);

/// Returns how unlike two places look around a patch, grey levels: `at` in frame t, and beside it (by
/// `beside`, px) in frame `other`.
double unlikeness_around(const SeenClip& clip, const graph::Patch& patch, graph::Point at, int t,
                         graph::Point beside, int other);

}  // namespace emberfold::pipeline
