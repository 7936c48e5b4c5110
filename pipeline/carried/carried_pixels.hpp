// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"

namespace emberfold::pipeline {

/// A patch whose surroundings are shown at another place, or at another time, than where they were seen.
struct CarriedPatch {
  graph::Point to, from;  ///< px: where it is shown, and where its pixels lie in their frame
  double theta = 0;       ///< rad: direction of its curve where it is shown
  double turn = 0;        ///< rad: direction of its curve in its frame, less that where it is shown
  double reach = 4;       ///< px about it that are shown whole

  bool operator==(const CarriedPatch&) const = default;
};

/// Patches whose pixels are of one frame of a footage.
struct CarriedStroke {
  int frame = 0;
  double opacity = 1;  ///< 0…1
  double fit = 0;      ///< grey levels, ≥ 0, by which pixels are fitted to those beside the stroke, at most
  double feather = 6;  ///< px beyond the patches' reach over which the pixels blend into the frame, > 0
  std::vector<CarriedPatch> patches;
  bool hides = false;  ///< a stroke that is there, with what lies beside it

  bool operator==(const CarriedStroke&) const = default;
};

/// Returns how far the pixels of a patch reach that belong to it, px: half its width and two blurs.
double carried_reach(const graph::Patch& patch);

/// Draws the pixels of a stroke into a frame, CV_8U with 1 or 3 channels: about every patch those about where
/// it was seen, between patches those between. On either side of its curve
/// they are brought to the levels that lie there in the frame, linearly across it: the membrane of
/// gradient-domain blending (Pérez, Gangnet & Blake 2003) along a strip. Where it differs by far more from
/// what lay beside it than that is changed by, its own levels stay. O(pixels about its patches).
void draw_carried(cv::Mat& frame, const std::vector<cv::Mat>& footage, const CarriedStroke& stroke);

}  // namespace emberfold::pipeline
