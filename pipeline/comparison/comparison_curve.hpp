// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/prediction.hpp"

namespace emberfold::pipeline {

struct TrainingInput;

/// Holds the quality of one model of one size.
struct SizeCurvePoint {
  std::string model, label;  ///< the kind's key; for display
  std::string size_text;     ///< "4 components", "a patch every 10 px"
  double parameters = 0;
  std::optional<FrameQuality> next_frame;  ///< held out; none where the model learned from all frames
  PixelDistances distances;                ///< of a drawn clip, at most 128 frames, from the source
};

/// Holds the quality of models against the number of their parameters.
struct SizeCurve {
  std::vector<SizeCurvePoint> points;
  std::optional<std::size_t> motion_model;   ///< the point of the motion model at its default size
  std::optional<std::size_t> equal_texture;  ///< best linear dynamic texture with no more parameters
};

/// Measures quality against the number of parameters: each kind of model in several sizes.
/// The motion model has patches 1, 2 and 4 times as far apart as `sketch.spacing`, which keeps the strokes
/// and halves the numbers that describe them. The linear dynamic texture has 1, 2, 4 … components, of whole
/// frames and of frames reduced to a half, a quarter and an eighth each way, which makes it as small as the
/// other models. STAR has neighbours up to 1, 2, 3 px away. Throws core::Cancelled.
SizeCurve measure_size_curve(const TrainingInput& input, const ClipMeasures& source,
                             const MeasureScale& scale);

}  // namespace emberfold::pipeline
