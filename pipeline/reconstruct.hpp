// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/rendering/render.hpp"
#include "sketch/texture/texture_fill.hpp"

namespace emberfold::pipeline {

/// Source of the patches' pixels: their attributes or the frame.
enum class PatchDrawing { fitted, pixels };

/// Holds a frame that was reconstructed from its sketch.
struct Reconstruction {
  cv::Mat bytes;     ///< CV_8U, channels of the frame
  double share = 0;  ///< share of the frame in patches and anchors, 0…1
  double psnr = 0;   ///< dB against the frame, at most dytex::kMostPsnr
  bool converged = true;
  int regions = 0;                ///< textures with which the background was drawn
  double histogram_distance = 0;  ///< of the background from the frame, 0…1; only with julesz
};

/// Draws the patches and anchors and fills the rest by diffusion.
/// A frame without either becomes its mean level. `levels`: CV_32F, white = 255.
Reconstruction reconstruct(const cv::Mat& levels, const graph::AttributeGraph& graph, PatchDrawing drawing);

/// Draws only the patches and anchors; patches from their attributes or with the frame's pixels.
sketch::Sketchable draw_patches(const cv::Mat& levels, const graph::AttributeGraph& graph,
                                PatchDrawing drawing);

/// Adds anchors to a frame's graph, at the pixels that the diffusion needs most around the patches' cores.
/// Together they show at most `share` (0…1) of the frame; adds none where the cores already show that much.
graph::AttributeGraph add_anchors(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                  PatchDrawing drawing, double share);

/// Fills the frame around what is drawn of its graph. Throws core::Cancelled.
Reconstruction reconstruct(const cv::Mat& levels, const sketch::Sketchable& drawn,
                           const sketch::NonsketchableFillOptions& ground, const core::Context& context = {});

}  // namespace emberfold::pipeline
