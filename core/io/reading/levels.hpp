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
  bool moves = false;   ///< values are moved so that black is 0, and clipped at both ends
  bool misses = false;  ///< some floats are not finite
};

/// Finds black and white of a clip. Reads all of it, and rewinds it, where they depend on its values: 16 bits
/// and floats unless they are given. Automatic levels begin at 0 unless values are below it or use less than
/// an eighth of the range. They leave out stray values: those that no three pixels in a row reach, where they
/// need two more bits than all others. Warns once of that, and where the depth is doubtful: odd numbers of
/// bits in use, floats above 1. `name`: the clip's, for warnings. Throws core::InputError for full levels of
/// a clip whose values are all equal, and for a clip of floats without a finite number.
LevelRange find_levels(FrameDecoder& clip, const Levels& levels, const std::string& name,
                       const core::Warn& warn);

/// Moves black to 0 and clips values outside; 8 bits are spread to 0…255. Other depths keep their steps, with
/// white at `white - black`. Unchanged where the range does not move values.
cv::Mat apply_levels(const cv::Mat& frame, const LevelRange& range);

/// Returns a warning where given levels make all of a frame black or all of it white; empty otherwise.
std::string outside_levels(const cv::Mat& frame, const Levels& levels);

}  // namespace emberfold::io
