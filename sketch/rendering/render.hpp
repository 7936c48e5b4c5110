// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds the sketchable part of a frame (Guo, Zhu & Wu 2007): what the patches show, and where.
struct Sketchable {
  cv::Mat levels;                      ///< CV_32F, 1 or 3 channels, white = 255; 0 off the mask
  cv::Mat mask;                        ///< CV_8U, 255 where a patch or an anchor lies
  [[nodiscard]] double share() const;  ///< of the frame's pixels, 0…1
};

/// Draws the patches from their attributes.
/// - Along every edge of the graph runs a smooth curve through both patches in their directions. A band about
///   it shows the profile of graph::Patch by the distance from the curve; attributes are linear from one end
///   to the other.
/// - A band reaches to each side as far as the profile changes: half a width and two blurs, at least 1.5 and
///   at most 12 px. Where bands overlap, the one whose middle is nearer counts more.
/// - A stroke ends 1 px behind its last patch. A patch without edges shows 5 px of itself.
/// - An edge that leaves a patch at more than 50° from its direction (a junction's side arm) takes only its
///   place from it.
/// - An anchor shows its pixel, over whatever lies there; one outside the frame shows nothing. In a graph
///   with anchors bands show their cores alone (draw_cores).
/// `channels`: 1 (luma) or 3. Throws core::InputError for any other number, or an empty size. O(pixels of the
/// mask), beside clearing the frame.
Sketchable draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels);

/// Draws the patches' cores: bands with 0.35 of their reach. Anchors are chosen around these: a pixel
/// where the picture needs it is worth more than one at the rim of a band. Otherwise as draw_fitted.
Sketchable draw_cores(const graph::AttributeGraph& graph, cv::Size size, int channels);

/// Holds a drawn sketch and a further value at each of its pixels.
struct AttributedSketch {
  Sketchable part;
  cv::Mat values;  ///< CV_32F, 0 off the mask
};
/// Draws the patches, and interpolates a value of each patch with the weights of its levels. `values`: one
/// for each patch, by index; throws core::InputError for another number of them.
AttributedSketch draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels,
                             std::span<const float> values);

/// Copies the frame's own pixels where draw_fitted would draw, but anchors keep their levels. `levels`:
/// CV_32F, 1 or 3 channels.
Sketchable draw_pixels(const graph::AttributeGraph& graph, const cv::Mat& levels);

/// Holds the pixels of the graph's anchors in what is drawn of it; every drawing ends with this.
Sketchable hold_anchors(const Sketchable& drawn, const graph::AttributeGraph& graph);

}  // namespace emberfold::sketch
