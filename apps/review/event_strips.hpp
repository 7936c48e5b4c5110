// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apps/cli/command.hpp"
#include "apps/pictures/still.hpp"
#include "core/clip.hpp"
#include "graph/events/events.hpp"

namespace emberfold::apps {

constexpr int kStripFrames = 7;  ///< for an event at frame t, t − 3 to t + 3
constexpr int kStripCell = 96;   ///< px, side of a frame's part

/// Returns the distance from the event to each side of a strip, px of the clip: an eighth of the longer side,
/// 24 to 96.
int strip_reach(const core::ClipInfo& info);

/// Draws a strip for each event: the square around it in seven frames, side by side. Outside the picture or
/// the clip it is grey. Each takes at most `most_bytes` (≥ 4096). In the order of `events`, which is
/// arbitrary. Reads the clip once and holds the strips of seven frames. Throws core::Cancelled.
std::vector<Still> draw_event_strips(core::FrameSource& source, std::span<const graph::Event> events,
                                     std::size_t most_bytes, const Session& session);

}  // namespace emberfold::apps
