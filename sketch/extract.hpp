// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds the settings of extract().
struct ExtractOptions {
  /// 0…1: how much is drawn, from little that is sure to all that may be there; moves along the curve of
  /// precision and recall.
  double sensitivity = 0.5;
  double finest_scale = 1.2;  ///< px, 0.7…20: SD of the finest Gaussian
  int scales = 5;             ///< 1…12, each √2 above the one before
  double significance = 6;    ///< > 0: SD of the noise response at which a curve begins that its points show
  double hysteresis = 0.4;    ///< above 0, up to 1: share of `significance` down to which a curve goes on
  double min_contrast = 2;    ///< grey levels, ≥ 0: fainter strokes are left out
  double min_length = 12;     ///< px, ≥ 0: shorter curves that end freely are left out
  double min_evidence =
      28;              ///< SD, ≥ 0: least root of the sum of the squared significances of a curve's points
  double spacing = 5;  ///< px, 2…100: from patch to patch along a curve
  bool steady = true;  ///< of a clip: sketches agree with those before and after (steadying/)
  bool edges = true;   ///< step edges too, not only ridges and valleys
  /// Boundaries of things in photographs instead: steps where the brightness or the texture of both sides
  /// differs, with `colour` also where their colours do.
  bool boundaries = false;
  bool colour = false;  ///< structure from two axes of colour too, not only from luma
  bool blobs = false;   ///< blobs too, where the fill between the strokes leaves more than noise
  /// 0…1: share of the frame that patches, blobs included, may show; those of most gain come first. 0: all
  /// that pay.
  double budget = 0;
  /// px, 64…16384: a frame that is wider or higher is sketched in parts that are not, in parallel, which
  /// bounds the memory; its thresholds are those of the whole frame.
  int tile = 2048;

  void validate() const;
};

/// Estimates the SD of the pixel noise in grey levels. Median absolute deviation of the finest diagonal
/// wavelet; at least 0.29, the SD of quantisation. `luma`: CV_32F. O(pixels).
double estimate_noise(const cv::Mat& luma);

/// Extracts the primal sketch of one frame. `levels`: CV_32F, 1 or 3 channels, finite, white = 255. Structure
/// is found in luma, with `colour` also in red − green and blue − yellow, scaled so that white noise is as
/// strong in all three; a patch's contrast is that of the axis in which it is strongest. Patches carry their
/// cost and gain. Vertex ids count from 0. A frame without structure gives an empty graph. Throws
/// core::InputError. Steger 1998 (subpixel lines), Lindeberg 1998 (scale); docs/method/sketch.md has the
/// steps.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options);

/// Extracts the sketch along curves that come from elsewhere, in place of those that are found.
/// `probability`: as large as the frame, 0…1, that a curve runs through a pixel; a curve begins where it
/// reaches 1 − sensitivity. Throws core::InputError.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options,
                              const cv::Mat1f& probability);

}  // namespace emberfold::sketch
