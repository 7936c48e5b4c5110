// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "mcmc/learning/stroke_statistics.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/comparison_results.hpp"

namespace emberfold::pipeline {

using OptionalStrokes = std::optional<mcmc::StrokeStatistics>;

/// Returns the profile of a clip from its gathered measures.
ClipProfile clip_profile(const ClipMeasures& pixels, const OptionalStrokes& strokes);

/// Measures the distances of a clip from a reference; those of strokes only where both are known.
ClipDistances clip_distances(const ClipMeasures& pixels, const OptionalStrokes& strokes,
                             const ClipMeasures& reference, const OptionalStrokes& reference_strokes);

/// Measures the distances of a source's first half from its second. `strokes`: of all its frames, or null.
ClipDistances noise_floor(const SourceMeasures& source, const mcmc::StrokeSeries* strokes);

/// Reads a source's next frames as levels, at most `most`. Throws core::Cancelled.
std::vector<cv::Mat> next_levels(core::FrameSource& source, int most, const core::Context& context);

}  // namespace emberfold::pipeline
