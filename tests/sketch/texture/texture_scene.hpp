// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "sketch/inpainting/fill.hpp"
#include "sketch/texture/texture_regions.hpp"
#include "tests/support/still_textures.hpp"

namespace emberfold::test {

inline const cv::Size kTextureSize(96, 72);

/// A frame of which `mask` is held, and what a texture is drawn from.
struct TextureScene {
  cv::Mat frame, mask, start;
  sketch::TextureRegions regions;
};

/// Starts from the diffusion of the held pixels, or from the mean of the frame where none is held.
inline TextureScene texture_scene(const cv::Mat& frame, const cv::Mat& mask, int count = 1) {
  cv::Mat start = sketch::fill(frame, mask).levels;
  if (cv::countNonZero(mask) == 0) start.setTo(cv::mean(frame));
  return {frame, mask, start, sketch::segment_texture(frame, mask, {.regions = count})};
}

}  // namespace emberfold::test
