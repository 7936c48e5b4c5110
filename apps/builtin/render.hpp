// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "apps/builtin/scene.hpp"

namespace emberfold::apps {

inline constexpr double builtin_noise = 2;  ///< standard deviation of the pixel noise, grey levels

/// Renders one frame, CV_8UC3. Depends on the scene and the frame's number alone.
cv::Mat render_frame(const Scene& scene, int frame);

/// Renders the strokes alone, before colour and noise: CV_32F, grey levels (heat, for fire), ridges positive
/// and valleys negative. On a centre line the value is the stroke's contrast there.
cv::Mat render_strokes(const Scene& scene, int frame);

/// Returns the contrast at point i of a curve of n points at full presence, flicker included. It is a share
/// of the body's contrast, between 0.5 and 1.2.
double contrast_profile(const Scene& scene, const Body& body, std::size_t i, std::size_t n, int frame);

}  // namespace emberfold::apps
