// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sketch/detection/junctions.hpp"

namespace emberfold::sketch {

/// Adds the meetings of lines that run through each other: where two curves of one sign cross, and where the
/// ways between two pairs of ends do (both lines being lost in the crossing), these become one meeting. A
/// meeting of the same curves within 8 px is that crossing already. O(points · log).
CurveNetwork merge_crossings(CurveNetwork network);

}  // namespace emberfold::sketch
