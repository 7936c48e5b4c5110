// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"

namespace emberfold::pipeline {

/// Holds the visible cost of continuing from one frame of a footage with another.
struct LikeMoments {
  int frames = 0;
  int half = 0;       ///< frames on each side that are compared
  cv::Mat1f cost;     ///< frames × frames, from row `a` to column `b`; infinite where no jump is allowed
  double change = 0;  ///< mean distance of neighbouring frames, grey levels
  double best = 0;    ///< mean cost of the best jumps, grey levels

  /// Returns whether any jump is possible.
  [[nodiscard]] bool can_jump() const { return best < 1e30; }
};

/// Compares all pairs of frames of a footage (CV_8U).
/// The cost of showing frame b after frame a is the mean distance between the frames around a + 1 and b,
/// which compares motion, too (Schödl et al. 2000, "Video textures", eqs. 1–2). The distance of two frames is
/// the root mean square difference of pictures of at most 80 px. O(frames²). Throws core::Cancelled.
LikeMoments compare_moments(const std::vector<cv::Mat>& footage, const core::Context& context);

}  // namespace emberfold::pipeline
