// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "pipeline/comparison/comparison_results.hpp"

namespace emberfold::pipeline {

struct ComparedModel;

/// Returns 1, 2, 4 …, and `most` itself.
std::vector<int> prediction_steps(int most);

/// Measures the predictions of frames first … frames − 1, and the reconstruction of given frames.
/// From at most 32 starts, evenly spread, every model predicts all steps, and so do two methods without a
/// model: repeating the frame before ("frame_before"), and the mean image of the frames before `first`
/// ("mean_image"). Frames are rounded to 8 bits and compared. Holds a batch of frames. Throws
/// core::Cancelled.
PredictionMeasures measure_prediction(core::FrameSource& source, int first, int frames,
                                      std::span<const int> steps, std::span<const ComparedModel> models,
                                      const core::Context& context);

}  // namespace emberfold::pipeline
