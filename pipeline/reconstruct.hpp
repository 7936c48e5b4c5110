// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"
#include "sketch/texture/texture_fill.hpp"

namespace emberfold::pipeline {

enum class PatchDrawing { fitted, pixels, learned };

/// A frame drawn again from its sketch.
struct Reconstruction {
  cv::Mat bytes;     ///< CV_8U, channels of the frame
  double share = 0;  ///< held: of patches and anchors, 0…1
  double psnr = 0;   ///< dB against the frame, at most dytex::kMostPsnr
  bool converged = true;
  int regions = 0;                ///< textures that the ground was drawn with
  double histogram_distance = 0;  ///< of the ground from the frame, 0…1; only with julesz
};

/// Draws the patches and fills the rest by diffusion; a frame without patches becomes its mean level.
/// `levels`: CV_32F, white = 255.
Reconstruction reconstruct(const cv::Mat& levels, const graph::AttributeGraph& graph, PatchDrawing drawing,
                           const sketch::FillOptions& options);

/// The patches as they are drawn, from their attributes or with the frame's pixels.
sketch::Sketchable draw_patches(const cv::Mat& levels, const graph::AttributeGraph& graph,
                                PatchDrawing drawing);

/// The patches and as many of the frame's own pixels, where the diffusion needs them most, that both together
/// show at most `share` (0…1) of it; none where the patches show as much already.
sketch::Sketchable add_anchors(const sketch::Sketchable& patches, const cv::Mat& levels, double share);

/// Draws the rest of the frame around what is held. Throws core::Cancelled.
Reconstruction reconstruct(const cv::Mat& levels, const sketch::Sketchable& held,
                           const sketch::NonsketchableFillOptions& ground, const core::Context& context = {});

/// {"mean", "min", "max", "frames"}, null where there is none.
nlohmann::ordered_json spread_json(std::span<const double> values);

}  // namespace emberfold::pipeline
