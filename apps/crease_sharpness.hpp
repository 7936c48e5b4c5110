// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "graph/motion_graph.hpp"

// How sharp a frame is along its sketched creases, and what makes drawn ones as sharp as those of the clip: a
// profile that is fitted over some px along its crease comes out more blurred than what it was fitted to.
namespace emberfold::apps {

/// The gradient's magnitude (grey levels a px, Sobel) on the flanks of a frame's patches: half a width (a
/// line's blur, if larger) to each side of a line, on a step itself. Means over places inside the frame.
struct CreaseSharpness {
  double sum = 0;
  std::size_t places = 0;
  [[nodiscard]] double mean() const { return places > 0 ? sum / static_cast<double>(places) : 0; }
};
/// `luma`: CV_32F, white = 255.
CreaseSharpness crease_sharpness(const cv::Mat& luma, const graph::AttributeGraph& graph);

/// The share of their fitted blur, 0.25…1, with which the patches of a clip are to be drawn so that its
/// creases are as sharp as they are in the clip: from at most eight frames spread over it, by bisection. 1
/// where there are no patches. Reads the clip once; throws Interrupted.
double fit_blur_share(core::FrameSource& source, const graph::SketchSequence& sketch,
                      const core::Context& context = {});

/// The array "blur_share" beside a motion model's own, one number.
void add_blur_share(core::ModelArchive& archive, double share);
/// 1 where the archive has none; core::IoError where it is no number in [0.1, 1].
double read_blur_share(const core::ModelArchive& archive);

}  // namespace emberfold::apps
