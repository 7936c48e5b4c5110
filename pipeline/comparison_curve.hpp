// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/clip_measures.hpp"
#include "pipeline/compared_models.hpp"

namespace emberfold::pipeline {

/// Quality against the number of parameters: every kind of model learned in several sizes from the same
/// first part. The motion model with patches 1, 2 and 4 times as far apart as `sketch.spacing` tells, which
/// leaves the strokes and halves the numbers that describe them; the linear dynamic texture with 1, 2, 4 …
/// components of whole frames and of frames reduced to a half, a quarter, an eighth each way (which is how it
/// gets as small as the others); STAR with neighbours up to 1, 2, 3 px away.
/// {"points": [{"model", "label", "what", "parameters", "psnr", "ssim" (of the next frame, held out; null
/// without such), "temporal_db", …: the pixel measures of a drawn clip of at most 128 frames}], "equal": for
/// the motion model's size the best linear dynamic texture that is no larger}. Throws core::Cancelled.
nlohmann::ordered_json size_curve(const ModelInput& input, const ClipMeasures& source,
                                  const MeasureScale& scale);

}  // namespace emberfold::pipeline
