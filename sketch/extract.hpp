// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

struct ExtractOptions {
  double finest_scale = 1.2;  ///< px, ≥ 0.7: SD of the finest Gaussian
  int scales = 5;             ///< ≥ 1, each √2 above the one before
  double significance = 6;    ///< > 0: a curve begins where the response is so many SD of the ground
  double hysteresis = 0.4;    ///< 0…1: and goes on down to this share of it
  double min_contrast = 2;    ///< grey levels, ≥ 0: fainter strokes are left out
  double min_length = 12;     ///< px, ≥ 0: shorter curves that end freely are left out
  double min_evidence =
      28;  ///< SD, ≥ 0: curves whose points' significance (root of the sum of squares) is less are left out
  double spacing = 5;          ///< px, ≥ 2: from patch to patch along a curve
  bool edges = true;           ///< step edges too, not only ridges and valleys
  bool colour = false;         ///< structure from two axes of colour too, not only from luma
  bool blobs = false;          ///< blobs too, where the fill between the strokes leaves more than noise
  bool double_ridges = false;  ///< two lines side by side become one double ridge, where that pays
  double budget = 0;  ///< 0…1: the patches, blobs among them, that gain most show this share of the frame at
                      ///< most; 0: all that pay

  void validate() const;
};

/// SD of the pixel noise in grey levels, from the finest diagonal wavelet (median absolute deviation); at
/// least the quantisation's 0.29.
double estimate_noise(const cv::Mat& luma);

/// The primal sketch of one frame. `levels`: CV_32F, 1 or 3 channels, white = 255; structure is found in its
/// luma, with `colour` also in red − green and blue − yellow, scaled so that white noise is as strong in all
/// three; a patch's contrast is then that of the axis in which it is strongest. Patches carry their cost and
/// gain. Vertex ids count from 0. Steger 1998 (subpixel lines), Lindeberg 1998 (scale); docs/method/sketch.md
/// has the rest. A frame without structure gives an empty graph.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options);

/// The same with a warm start: strokes of `previous`, the sketch of the frame before, that are not found are
/// looked for where they were, up to 4 px across, and are in the sketch where they show at half of their
/// contrast and shorten the frame's code. So faint strokes flicker less; all else is as from a cold start.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options,
                              const graph::AttributeGraph& previous);

}  // namespace emberfold::sketch
