// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/rendering/render.hpp"

namespace emberfold::sketch {

/// Holds the settings of choose_anchors().
struct AnchorOptions {
  int rounds = 8;       ///< 0…256: number of fills that place anchors by their error; 0: by |Δu| alone
  double spread = 0.8;  ///< px, 0.3…5: SD of the Gaussian g that weighs shared errors
  void validate() const;
};

/// Chooses pixels that, held beside the taken ones, bring the diffusion of fill() closest to the frame.
/// Returns CV_8U, 255 at the anchors, which never lie on taken pixels. There are at most ⌊share · pixels⌋;
/// fewer only where the fill is exact without more, or no pixel is left. `levels`: CV_32F, 1 or 3 channels
/// finite; `taken`: CV_8U of the same size; share 0…1. Throws core::InputError otherwise.
///
/// The first 15 % lie where |Δu| is greatest, u being smoothed a little: the best density of held pixels
/// grows with |Δu| (Belhachmi, Bucur, Burgeth & Weickert 2009, "How to choose interpolation data in images").
/// Then in each round the frame is filled from all held pixels, and the next anchors are put on peaks of
/// e·(g∗e), summed over channels, e being the error and g a Gaussian of SD `spread`: an anchor corrects its
/// own error and, as far as they are alike, its neighbours'. Only peaks of 3 × 3 pixels count, so that
/// anchors keep apart, except for the rest of the last round.
///
/// Flips and quarter turns of the frame turn the anchors with it, up to ties and the tolerance of the fill.
/// With no rounds the density |Δu|^0.8 is halftoned by error diffusion instead (Floyd & Steinberg 1976): much
/// faster, some 3 dB less. O(pixels) a round; one thread.
cv::Mat choose_anchors(const cv::Mat& levels, const cv::Mat& taken, double share,
                       const AnchorOptions& options = {});

/// Chooses anchors around patches as they are drawn, whose levels may differ from the frame's.
cv::Mat choose_anchors(const cv::Mat& levels, const Sketchable& drawn, double share,
                       const AnchorOptions& options = {});

/// Adds an anchor at each pixel of `mask` (CV_8U) with the frame's level there, row by row, after the
/// vertices of the graph. `levels`: CV_32F, 1 or 3 channels, finite, of the mask's size; throws
/// core::InputError otherwise.
graph::AttributeGraph add_anchors(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                  const cv::Mat& mask);

}  // namespace emberfold::sketch
