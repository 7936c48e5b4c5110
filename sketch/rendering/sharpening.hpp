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

// What makes the strokes of drawn clips as steep as those of the clip they are learned from: a profile that
// is fitted over some px along its crease comes out more blurred than what it was fitted to. Unlike the
// crease sharpness of dytex/measures/sharpness_si_ti.hpp, which clips are compared by, the gradient here is
// that of strokes in a known sketch, and grows with their contrast.
namespace emberfold::sketch {

/// The gradient's magnitude (grey levels a px, Sobel) on the flanks of a frame's patches: half a width (a
/// line's blur, if larger) to each side of a line, on a step itself. Means over places inside the frame.
struct FlankGradient {
  double sum = 0;
  std::size_t places = 0;
  [[nodiscard]] double mean() const { return places > 0 ? sum / static_cast<double>(places) : 0; }
};
/// `luma`: CV_32F, white = 255.
FlankGradient measure_flank_gradient(const cv::Mat& luma, const graph::AttributeGraph& graph);

/// Of at most eight frames spread over a clip together. Reads the clip once; throws core::Cancelled.
FlankGradient measure_clip_flank_gradient(core::FrameSource& source, const graph::SketchSequence& sketch,
                                          const core::Context& context = {});

/// How the patches of new clips are drawn.
struct Sharpening {
  double blur_share = 1;     ///< of their fitted blur, 0.25…1
  double contrast_gain = 1;  ///< 1…1.5
};
/// With what the frames of these graphs come as near as they can to a flank gradient `target`, by bisection:
/// first less blur, then, where that is not enough, more contrast. Neither where they are that steep or have
/// no patches. Throws core::Cancelled. Draws the frames some 15 times.
Sharpening fit_sharpening(std::span<const FrameContent> content, RenderOptions options, double target,
                          const core::Context& context = {});

/// The look of frames that are drawn so.
RenderOptions apply_sharpening(RenderOptions options, const Sharpening& sharpening);

/// The array "sharpening" beside a motion model's own: blur_share, contrast_gain.
void add_sharpening(core::ModelArchive& archive, const Sharpening& sharpening);
/// None where the archive has none; core::IoError where it is not two numbers in [0.1, 1] and [1, 10].
Sharpening read_sharpening(const core::ModelArchive& archive);

}  // namespace emberfold::sketch
