// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "sketch/background/still_background.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"

// The levels of patches that come and go.
namespace emberfold::sketch {

constexpr float kOpaque = 0.999F;  ///< a opacity from which on nothing is missing

/// What the patches that are not quite there show. The frame's smooth part is the mean, over all shares s, of
/// the fill of those patches of which at least s is there: so a stroke that begins to fade tells on all
/// others by as little as on itself. To it comes what each patch's own levels have beyond it, by its share.
/// `opacity`: CV_32F, 0…1; `empty_level`: of a frame that nothing is left in.
void blend_with_fill(sketch::Sketchable& part, const cv::Mat& opacity, const BackgroundImage& background,
                     float empty_level, const sketch::FillOptions& options);

/// The same on a ground, which is what is there without them.
void blend_with_background(sketch::Sketchable& part, const cv::Mat& opacity, const cv::Mat& background);

}  // namespace emberfold::sketch
