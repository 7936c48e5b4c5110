// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// Draws the mean, the first components and the first states of a texture, CV_8UC3. Components are labelled
/// with their shares of the variance; for a positive state blue is darker than the mean, red brighter. States
/// are drawn over the training frames.
cv::Mat draw_components(const dytex::LinearDynamicTexture& texture);

}  // namespace emberfold::apps
