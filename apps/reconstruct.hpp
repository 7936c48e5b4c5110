// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/fill.hpp"
#include "sketch/render.hpp"

namespace emberfold::apps {

enum class PatchDrawing { fitted, pixels };

/// A frame drawn again from its sketch.
struct Reconstruction {
  cv::Mat bytes;     ///< CV_8U, channels of the frame
  double share = 0;  ///< sketchable, 0…1
  double psnr = 0;   ///< dB against the frame, at most kMostPsnr
  bool converged = true;
};
constexpr double kMostPsnr = 100;

/// Draws the patches and fills the rest by diffusion; a frame without patches becomes its mean level.
/// `levels`: CV_32F, white = 255.
Reconstruction reconstruct(const cv::Mat& levels, const graph::AttributeGraph& graph, PatchDrawing drawing,
                           const sketch::FillOptions& options);

/// The same with a sketchable part that is drawn already.
Reconstruction reconstruct(const cv::Mat& levels, const sketch::Sketchable& part,
                           const sketch::FillOptions& options);

/// 10 log₁₀(255² / MSE) over all pixels and channels of two CV_32F frames; kMostPsnr where they hardly
/// differ.
double psnr(const cv::Mat& a, const cv::Mat& b);

/// {"mean", "min", "max", "frames"}, null where there is none.
nlohmann::ordered_json spread_json(std::span<const double> values);

}  // namespace emberfold::apps
