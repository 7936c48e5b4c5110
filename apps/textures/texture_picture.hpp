// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// What a linear dynamic texture is made of, CV_8UC3: its mean and first components (blue: darker than the
/// mean, red: brighter, where the state is positive) with their shares of the variance, and below them the
/// courses of the first states over the frames that it was learned from.
cv::Mat draw_components(const dytex::LinearDynamicTexture& texture);

}  // namespace emberfold::apps
