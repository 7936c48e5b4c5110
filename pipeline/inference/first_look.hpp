// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/events/events.hpp"

namespace emberfold::pipeline {

/// A channel of a clip in colour that shows more than the luma, which is what is followed.
struct ClearerChannel {
  int channel = 0;   ///< 0 red, 1 green, 2 blue, as ReadOptions::channel
  double times = 0;  ///< its contrast by that of the luma
};

/// What is seen of a clip before anything is followed.
struct FirstLook {
  /// Frames, ascending, at which the picture changes: a cut of the film, black frames and the first frame
  /// after them, a flash. There half of the pixels change by 6 grey levels or more, and the correlation with
  /// the frame before is less than half of the clip's median.
  std::vector<int> cuts;
  /// The channel with the greatest contrast, if this is at least 4 times that of the luma: where things have
  /// another colour than their ground but no other brightness, or are blue on black (8.8 times). Contrast is
  /// the root of the mean square difference of neighbouring pixels.
  std::optional<ClearerChannel> clearer;
};

/// Looks over a clip's frames, reduced to 64 px across. Reads it once, O(pixels). Throws core::Cancelled.
FirstLook look_over(core::FrameSource& source, const core::Context& context);

/// Sets the probability of events within one frame of a cut to 0: strokes that a cut ends or begins are no
/// events.
void disbelieve_cuts(std::vector<graph::Event>& events, const std::vector<int>& cuts);

}  // namespace emberfold::pipeline
