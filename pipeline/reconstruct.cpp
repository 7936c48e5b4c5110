// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reconstruct.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/measures/psnr.hpp"
#include "sketch/inpainting/anchors.hpp"

namespace emberfold::pipeline {

sketch::Sketchable draw_patches(const cv::Mat& levels, const graph::AttributeGraph& graph,
                                PatchDrawing drawing) {
  return drawing == PatchDrawing::fitted ? sketch::draw_fitted(graph, levels.size(), levels.channels())
                                         : sketch::draw_pixels(graph, levels);
}

graph::AttributeGraph add_anchors(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                  PatchDrawing drawing, double share) {
  sketch::Sketchable drawn = sketch::draw_cores(graph, levels.size(), levels.channels());
  if (drawing == PatchDrawing::pixels) levels.copyTo(drawn.levels, drawn.mask);
  const auto pixels = static_cast<double>(levels.total());
  // The small number keeps shares that are whole pixels whole.
  const double room = std::floor(share * pixels + 1e-9) - cv::countNonZero(drawn.mask);
  if (room < 1) return graph;
  // Half a pixel more, so that rounding does not remove one.
  const cv::Mat anchors = sketch::choose_anchors(levels, drawn, std::min(1.0, (room + 0.5) / pixels));
  return sketch::add_anchors(graph, levels, anchors);
}

Reconstruction reconstruct(const cv::Mat& levels, const graph::AttributeGraph& graph, PatchDrawing drawing) {
  return reconstruct(levels, draw_patches(levels, graph, drawing), sketch::NonsketchableFillOptions{});
}

Reconstruction reconstruct(const cv::Mat& levels, const sketch::Sketchable& drawn,
                           const sketch::NonsketchableFillOptions& ground, const core::Context& context) {
  const auto filled = sketch::fill_nonsketchable(levels, drawn, ground, context);
  Reconstruction result;
  result.share = drawn.share();
  result.converged = filled.converged;
  result.regions = filled.regions;
  result.histogram_distance = filled.histogram_distance;
  result.bytes = core::to_bytes(filled.levels);
  cv::Mat shown;
  result.bytes.convertTo(shown, CV_32F);
  result.psnr = dytex::psnr(dytex::mean_square_error(shown, levels));
  return result;
}

}  // namespace emberfold::pipeline
