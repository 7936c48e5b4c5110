// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "graph/motion_graph.hpp"
#include "sketch/rendering/frame_renderer.hpp"

// Sharpening of the strokes of drawn clips. A profile that is fitted over some px along its crease comes out
// more blurred than the clip's own; sharpening restores the gradient of the clip that the strokes are learned
// from. Unlike the crease sharpness of dytex/measures/sharpness_si_ti.hpp, by which clips are compared, the
// gradient here is that of strokes in a known sketch, and grows with their contrast.
namespace emberfold::sketch {

/// Holds the gradient's magnitude on the flanks of patches, summed over places. Grey levels a px (Sobel).
struct FlankGradient {
  double sum = 0;
  std::size_t places = 0;
  [[nodiscard]] double mean() const { return places > 0 ? sum / static_cast<double>(places) : 0; }
};
/// Measures the gradient half a width to each side of lines (or a blur, if larger), and on steps. Places
/// within 4 px of the border do not count. `luma`: CV_32F, white = 255. O(pixels + patches).
FlankGradient measure_flank_gradient(const cv::Mat& luma, const graph::AttributeGraph& graph);

/// Measures at most eight frames spread over a clip, and sums them. Reads the clip once. Throws
/// core::Cancelled.
FlankGradient measure_clip_flank_gradient(core::FrameSource& source, const graph::SketchSequence& sketch,
                                          const core::Context& context = {});

/// Finds the sharpening with which drawn frames come nearest to a flank gradient `target`. Bisects first over
/// less blur, then, where that is not enough, over more contrast. Returns no change where the frames are that
/// steep or have no patches. Draws the frames about 15 times. Throws core::Cancelled.
Sharpening fit_sharpening(std::span<const FrameContent> content, RenderOptions options, double target,
                          const core::Context& context = {});

/// Returns the options of frames that are drawn with this sharpening.
RenderOptions apply_sharpening(RenderOptions options, const Sharpening& sharpening);

/// Adds the array "sharpening" to a motion model's archive: blur_share, contrast_gain.
void add_sharpening(core::ModelArchive& archive, const Sharpening& sharpening);
/// Reads it from an archive; no change where it has none. Throws core::IoError where it is not two numbers in
/// [0.1, 1] and [1, 10].
Sharpening read_sharpening(const core::ModelArchive& archive);

}  // namespace emberfold::sketch
