// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// What a chain starts from: the noisy copy of that index; none: the clip itself.
using StartReading = std::optional<std::size_t>;
/// Returns what each chain starts from: the clip, a noisy copy, the clip, another copy, and so on.
std::vector<StartReading> readings(const StartOptions& options);

/// Returns a frame with white Gaussian noise, independent in all channels and not clipped; luma has the SD
/// `sd`. `levels`: CV_32F. The noise depends on (seed, copy, frame) alone.
cv::Mat add_noise(const cv::Mat& levels, double sd, std::uint64_t seed, std::uint32_t copy,
                  std::uint32_t frame);

/// Holds the sketch of the clip and those of the noisy copies that the interpretations need.
struct StartSketches {
  SketchedClip clip;
  std::vector<graph::SketchSequence> perturbed;
};

/// Sketches each frame and its noisy copies, reading the clip once.
/// The noise is that of add_noise(), of 2 levels. Holds some frames and all graphs. Throws InputError,
/// core::Cancelled. Cost: 1 + copies sketches per frame.
StartSketches sketch_starts(core::FrameSource& source, const sketch::ExtractOptions& extract,
                            const StartOptions& options, std::uint64_t seed, const core::Context& context);

/// Matches every interpretation and returns a start for each chain, with strokes identified.
/// Chains with the same interpretation start alike. Throws InputError where the number of copies does not fit
/// the interpretations, and core::Cancelled.
std::vector<graph::MotionGraph> match_starts(const StartSketches& sketches, const graph::MatchOptions& match,
                                             const StartOptions& options, const core::Context& context);

}  // namespace emberfold::pipeline
