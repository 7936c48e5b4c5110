// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/clip_model.hpp"

// The frames of a clip as a part of its model: new clips can be made from them instead of from strokes.
namespace emberfold::pipeline {

/// Maximum bytes of frames in a model: 300 frames of 1280×720 in colour.
constexpr std::size_t kMostFootage = std::size_t{3} * 1280 * 720 * 300;

/// Reads a clip and keeps its first frames, those that fit in `most` bytes and at least two.
/// Leaves out repeated frames, whose mean difference from the frame before is below a fifth of the median.
/// `motion`: the clip's graphs, of which those of the frames are kept; empty: none.
/// Warns of frames that are not kept. Throws core::Cancelled.
Footage gather_footage(core::FrameSource& source, const graph::MotionGraph& motion,
                       const core::Context& context, std::size_t most = kMostFootage);

/// Decompresses the frames: CV_8U. Throws core::IoError where one is broken, core::Cancelled.
std::vector<cv::Mat> decode(const Footage& footage, const core::Context& context = {});

/// Adds the arrays "footage" and "footage_ends" to a motion model's archive, about a tenth of the frames'
/// bytes, and the strokes (add_footage_strokes).
void add_footage(core::ModelArchive& archive, const Footage& footage);
/// Reads the footage without its strokes; empty where the archive has none. Decodes the first frame alone.
/// Throws core::IoError, naming the array, where they do not hold frames of that size.
Footage read_footage(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::pipeline
