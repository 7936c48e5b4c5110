// SPDX-License-Identifier: Apache-2.0
// For the sketch library's own sources and the page of a motion model; not installed.
#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core/types.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

using PatchValues = std::span<const float>;

/// Refers to what patches are drawn into: arrays of a frame's pixels, row by row, zeros at the beginning.
struct PatchPlanes {
  cv::Size size;
  int channels = 1;         ///< 1 or 3
  float* levels = nullptr;  ///< `channels` numbers a pixel, white = 255
  float* weights = nullptr;
  std::uint8_t* mask = nullptr;  ///< becomes 255 where a patch lies
  float* values = nullptr;       ///< a number a pixel, or none
  bool cores = false;            ///< draw only the cores of bands, for graphs with anchors
};

/// Draws the patches that are no anchors, as draw_fitted (render.hpp) says, without OpenCV's functions.
/// `values`: one of each patch, interpolated into planes.values; may be empty where that is none.
void draw_patches(const graph::AttributeGraph& graph, PatchValues values, const PatchPlanes& planes);

}  // namespace emberfold::sketch
