// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/morphing/morph.hpp"

namespace emberfold::sketch {

/// Holds how the frames of a morph are drawn.
struct MorphLook {
  int channels = 3;                    ///< 1 or 3
  float level_from = 0, level_to = 0;  ///< of a first and a last frame without patches, white = 255
};

/// Draws the frames of a morph in order, CV_8U: patches from their attributes, by their opacity, and the rest
/// by diffusion, so that flat regions change with the strokes around them. The first and the last frame are
/// the reconstructions of both sketches. `take` gets each frame on one thread at a time. Throws
/// core::InputError for other channels, core::Cancelled. A render_frame() a frame.
void draw_morph(const graph::Morph& morph, const MorphLook& look,
                const std::function<void(const cv::Mat&)>& take, const core::Context& context = {});

}  // namespace emberfold::sketch
