// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// The sketchable part of a frame: what the patches show, and where.
struct Sketchable {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, white = 255; only the pixels of the mask mean anything
  cv::Mat mask;    ///< CV_8U, 255 where a patch lies
  [[nodiscard]] double share() const;  ///< of the frame's pixels, 0…1
};

/// Draws the patches from their attributes: along every edge of the graph the profile goes over from one
/// end's to the other's. `channels` 1 or 3. O(pixels of the mask).
Sketchable draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels);

/// The same part of the frame as draw_fitted covers, with the frame's own pixels. `levels`: CV_32F.
Sketchable draw_pixels(const graph::AttributeGraph& graph, const cv::Mat& levels);

}  // namespace emberfold::sketch
