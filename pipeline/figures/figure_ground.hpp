// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "pipeline/figures/kept_image.hpp"

namespace emberfold::pipeline {

/// Says how frames are reduced before figures are looked for: by a whole factor, to some 150,000 pixels.
struct FigureView {
  int factor = 1;  ///< px of the frame to a pixel of the view, along each side
  cv::Size size;   ///< of the view, px

  /// Returns a place of the view in pixels of the frame.
  [[nodiscard]] graph::Point in_frame(double x, double y) const {
    return {(x + 0.5) * factor - 0.5, (y + 0.5) * factor - 0.5};
  }
  /// Returns a place of the frame in pixels of the view.
  [[nodiscard]] graph::Point in_view(graph::Point p) const {
    return {(p.x + 0.5) / factor - 0.5, (p.y + 0.5) / factor - 0.5};
  }
};
/// Returns the view of a clip's frames.
FigureView figure_view(const core::ClipInfo& info);
/// Returns the distance of each pixel of a view from the edges of a frame's graph, px of the view.
cv::Mat1f distance_from_edges(const graph::AttributeGraph& graph, const FigureView& view);
/// Returns the luma of a frame as the view shows it: CV_32F, white = 255, smoothed by a Gaussian of 1 px.
cv::Mat1f figure_level(const cv::Mat& frame, const core::ClipInfo& info, const FigureView& view);

inline constexpr int kFigureCell = 4;  // px of the view

/// The motion of a view's pixels to a neighbouring frame, on a grid of kFigureCell px.
struct FigureMotion {
  cv::Mat2f vectors;  ///< px of the view
  double gain = 1;    ///< of the light: levels there by levels here
};
/// Returns where a pixel of the view moves to.
cv::Point2d moved(const FigureMotion& motion, cv::Size view, double x, double y);

/// The brightness of figures, or their darkness, against the ground about them.
inline constexpr std::array<int, 2> kFigurePolarities = {-1, 1};

/// Holds what tells figures from their ground, for every place of a clip.
struct FigureGround {
  FigureView view;
  double noise = 0;                    ///< SD of the camera's noise in figure_level(), grey levels
  double least_half = 0;               ///< half of the least contrast of a figure, grey levels
  std::vector<FigureMotion> to, from;  ///< by frame: to the next one, to the one before
  std::vector<cv::Mat1b> masks;        ///< by frame, where figures count: 0 or 1; empty: everywhere
  /// By frame and polarity, on a grid of kFigureCell px: the level half way between figure and ground, and
  /// half of their contrast.
  std::vector<std::array<cv::Mat2f, 2>> levels;
  ImageBlocks blocks;  ///< that they lie in

  [[nodiscard]] std::size_t frames() const { return levels.size(); }
};

/// Measures the levels of figures and ground in a clip, which is read once.
/// The level half way between a figure and its ground is the mean level of the edges near by, weighted by
/// slope: those of the frame and, carried by optical flow, of the frames about it. An edge counts for bright
/// figures where it is brighter than its surroundings. Throws core::Cancelled. O(pixels).
FigureGround measure_figure_ground(core::FrameSource& source, const core::Context& context);

/// Returns the amplitude of figures of one polarity in a frame: −1 at the level of the ground, 0 on the
/// outline, 1 at the level of the figure; less where the contrast is too small to be seen. `polarity`: an
/// index of kFigurePolarities.
cv::Mat1f figure_amplitude(const FigureGround& ground, std::size_t frame, std::size_t polarity,
                           const cv::Mat1f& level);

}  // namespace emberfold::pipeline
