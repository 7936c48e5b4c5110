// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "apps/builtin/scene.hpp"

namespace emberfold::apps {

inline constexpr double builtin_noise = 2;  ///< standard deviation of the pixel noise, grey levels

/// One frame as CV_8UC3. Depends on the scene and the frame's number alone.
cv::Mat render_frame(const Scene& scene, int frame);

/// What the strokes add to the picture, before colour and noise: CV_32F, in grey levels (heat, for fire),
/// ridges positive and valleys negative. On a centre line it is the stroke's contrast at that point.
cv::Mat render_strokes(const Scene& scene, int frame);

/// Contrast at point i of a curve of n points at full presence, flicker included, as a share of its body's
/// contrast: between 0.5 and 1.2.
double profile(const Scene& scene, const Body& body, std::size_t i, std::size_t n, int frame);

}  // namespace emberfold::apps
