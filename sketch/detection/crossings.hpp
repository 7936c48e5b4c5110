// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sketch/detection/junctions.hpp"

namespace emberfold::sketch {

/// Merges the meetings of lines that run through each other into one. Such are two crossing curves of one
/// sign, and two pairs of ends whose connections cross (both lines being lost in the crossing). A meeting of
/// the same curves within 8 px is that crossing already. O(points · log).
CurveNetwork merge_crossings(CurveNetwork network);

}  // namespace emberfold::sketch
