// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/context.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Values of a clip that become black and white.
struct LevelRange {
  double black = 0, white = 255;
};

/// Finds black and white of a clip. Reads all of it, and rewinds it, where they depend on its values: 16 bits
/// and floats unless they are given. Warns once where the depth is doubtful: odd numbers of bits in use,
/// floats above 1, values in a small part of the range. `name`: the clip's, for that. core::InputError for
/// full levels of a clip whose values are all alike.
LevelRange find_levels(FrameDecoder& clip, const Levels& levels, const std::string& name,
                       const core::Warn& warn);

/// Moves black to 0 and cuts what lies outside; 8 bits are spread to 0…255. Other depths keep their steps,
/// with white at `white - black`. Unchanged where the range begins at 0 and was not asked for.
cv::Mat apply_levels(const cv::Mat& frame, const Levels& levels, const LevelRange& range);

}  // namespace emberfold::io
