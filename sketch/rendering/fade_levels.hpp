// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "sketch/background/still_background.hpp"
#include "sketch/rendering/render.hpp"

// The levels of patches that fade in or out.
namespace emberfold::sketch {

/// Opacity from which a patch counts as opaque.
constexpr float kOpaque = 0.999F;

/// Blends the patches that are not opaque with the fill that would show without them. The smooth part of the
/// frame is the mean, over all opacities s, of the fill from the patches of opacity s or more, so a patch
/// that fades changes its surroundings gradually. Each patch adds what its own levels have beyond the fill of
/// all patches, times its opacity. `part`: changed in place; `opacity`: CV_32F, 0…1; `empty_level`: of a
/// frame without patches and background, white = 255. Some 8 fills of a sixteenth of the frame.
void blend_with_fill(sketch::Sketchable& part, const cv::Mat& opacity, const BackgroundImage& background,
                     float empty_level);

}  // namespace emberfold::sketch
