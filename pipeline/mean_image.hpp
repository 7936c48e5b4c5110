// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::pipeline {

/// Holds the mean of a clip's frames.
struct MeanImage {
  cv::Mat levels;  ///< CV_32F, white = 255; empty without frames
  int frames = 0;
};

/// Computes the mean image of a clip, from its first frame on. Throws core::Cancelled.
MeanImage mean_image(core::FrameSource& source, const core::Context& context);

}  // namespace emberfold::pipeline
