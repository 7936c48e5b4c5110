// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// The sketchable part of a frame: what the patches show, and where.
struct Sketchable {
  cv::Mat levels;                      ///< CV_32F, 1 or 3 channels, white = 255; 0 off the mask
  cv::Mat mask;                        ///< CV_8U, 255 where a patch lies
  [[nodiscard]] double share() const;  ///< of the frame's pixels, 0…1
};

/// Draws the patches from their attributes. Along every edge of the graph runs a smooth curve through both
/// patches in their directions; a band about it shows the profile of graph::Patch at the pixel's distance
/// from the curve, its attributes going over linearly from one end's to the other's. To each side the band
/// reaches as far as the profile changes: half a width and two blurs, at least 1.5 and at most 12 px. Where
/// bands overlap the one whose middle is nearer counts more. A stroke ends 1 px behind its last patch; a
/// patch without edges shows 5 px of itself. A patch that an edge leaves at more than 50° from its
/// direction (a junction's, for its side arm) lends that edge its place only. From a double ridge a line goes
/// on as the nearer one of its two. A blob (without edges) shows its disc. `channels` 1 (the levels' luma)
/// or 3. InputError for any other, or an empty size. O(pixels of the mask) beside clearing the frame.
Sketchable draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels);

/// draw_fitted, and what is told of each patch beside its levels: two numbers, which go over from patch to
/// patch and are weighed as the levels are.
struct AttributedSketch {
  Sketchable part;
  cv::Mat values;  ///< CV_32FC2, 0 off the mask
};
/// `told`: for each patch, by index; InputError where their number is another.
AttributedSketch draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels,
                             std::span<const std::array<float, 2>> values);

/// The same part of the frame as draw_fitted covers, with the frame's own pixels. `levels`: CV_32F, 1 or 3
/// channels.
Sketchable draw_pixels(const graph::AttributeGraph& graph, const cv::Mat& levels);

}  // namespace emberfold::sketch
