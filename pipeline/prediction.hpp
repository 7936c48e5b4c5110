// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/clip.hpp"
#include "pipeline/compared_models.hpp"

namespace emberfold::pipeline {

/// 1, 2, 4 … and `most` itself.
std::vector<int> prediction_steps(int most);

/// How near what is foretold comes to the frames first … frames − 1, and what models show to what they are
/// given. From at most 32 moments, evenly spread, all steps are foretold by every model and two that need
/// none: the frame before shown again ("frame_before"), and the mean image of the frames before `first`
/// ("mean_image"). {"first_frame", "moments", "steps", "methods": {key: {"psnr", "ssim", "by_step": {"psnr",
/// "ssim"}}}, "per_frame": {key: psnr of one step}}: PSNR is that of the mean square error over all moments,
/// pixels and channels, of frames as 8 bits show them, SSIM the mean over moments, of luma. With them
/// "reconstruction": {key: {"psnr", "ssim"}}. Holds a batch of frames. Throws core::Cancelled.
struct Prediction {
  nlohmann::ordered_json prediction, reconstruction;
};
Prediction measure_prediction(core::FrameSource& source, int first, int frames, std::span<const int> steps,
                              std::span<const ComparedModel> models, const core::Context& context);

}  // namespace emberfold::pipeline
