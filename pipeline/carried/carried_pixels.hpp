// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"

namespace emberfold::pipeline {

/// A patch whose surroundings are shown at another place or time than in the clip.
struct CarriedPatch {
  graph::Point to, from;  ///< px: where it is shown, and its place in its source frame
  double theta = 0;       ///< rad: direction of its curve where it is shown
  double turn = 0;        ///< rad: direction of its curve in its source frame, less that where it is shown
  double reach = 4;       ///< px about it that are shown in full

  bool operator==(const CarriedPatch&) const = default;
};

/// Patches whose pixels come from one frame of a footage.
struct CarriedStroke {
  int frame = 0;
  double opacity = 1;  ///< 0…1
  double fit = 0;      ///< grey levels, ≥ 0, largest change that fits pixels to those next to the stroke
  double feather = 6;  ///< px beyond the patches' reach over which the pixels blend into the frame, > 0
  std::vector<CarriedPatch> patches;
  bool hides = false;  ///< hides a stroke: its pixels include the background next to them

  bool operator==(const CarriedStroke&) const = default;
};

/// Returns the radius of the pixels that belong to a patch, px: half its width and two blurs.
double carried_reach(const graph::Patch& patch);

/// Transfers the pixels of a stroke into a frame, CV_8U with 1 or 3 channels.
/// Around every patch it draws the pixels around its place in the source frame, and interpolates between
/// patches. On either side of the curve they are brought to the levels next to it in the frame, linearly
/// across it: the membrane of gradient-domain blending (Pérez, Gangnet & Blake 2003) along a strip. Where a
/// pixel differs from its former surroundings by far more than this changes it, it keeps its own levels.
/// O(pixels about its patches).
void draw_carried(cv::Mat& frame, const std::vector<cv::Mat>& footage, const CarriedStroke& stroke);

}  // namespace emberfold::pipeline
