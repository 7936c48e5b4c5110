// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::pipeline {

/// A channel of a clip in colour that shows more than the luma, which is what is followed.
struct ClearerChannel {
  int channel = 0;   ///< 0 red, 1 green, 2 blue, as ReadOptions::channel
  double times = 0;  ///< its contrast by that of the luma
};

/// Finds the channel with the greatest contrast if this is at least 4 times that of the luma: things of
/// another colour than their ground but no other brightness, or blue ones on black (8.8 times). Contrast:
/// root of the mean square difference of neighbours in frames reduced to 64 px across, where noise and
/// texture count little. Nothing for grey clips. Reads the clip once. Throws core::Cancelled. O(pixels).
std::optional<ClearerChannel> find_clearer_channel(core::FrameSource& source, const core::Context& context);

}  // namespace emberfold::pipeline
