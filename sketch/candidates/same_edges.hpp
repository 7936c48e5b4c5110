// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "sketch/detection/curve_tracing.hpp"
#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

/// Leaves out the parts of curves that lie along other curves: within 3 px, or 1.5 times the smoothing at
/// which a curve was found. They are the same edges and lines in another channel; videos blur colours and
/// shift them, and an edge that is shifted has a thin line next to it. Parts of fewer than 5 points are
/// dropped. `space`: of `curves`; `size`: of the frame. O(pixels + points).
std::vector<Chain> without_same_edges(std::vector<Chain> curves, const ScaleSpace& space,
                                      const std::vector<Chain>& others, cv::Size size);

}  // namespace emberfold::sketch
