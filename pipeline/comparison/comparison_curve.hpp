// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/comparison_results.hpp"

namespace emberfold::pipeline {

struct TrainingInput;

/// Measures quality against the number of parameters: each kind of model in several sizes.
/// The motion model has patches 1, 2 and 4 times as far apart as `sketch.spacing`, which keeps the strokes
/// and halves the numbers that describe them. The linear dynamic texture has 1, 2, 4 … components, of whole
/// frames and of frames reduced to a half, a quarter and an eighth each way, which makes it as small as the
/// other models. STAR has neighbours up to 1, 2, 3 px away. Throws core::Cancelled.
SizeCurve measure_size_curve(const TrainingInput& input, const ClipMeasures& source,
                             const MeasureScale& scale);

}  // namespace emberfold::pipeline
