// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "sketch/rendering/render.hpp"

namespace emberfold::sketch {

struct AnchorOptions {
  int rounds = 16;  ///< 0…256: how often the frame is filled to see where it is worst; 0: curvature alone
  double spread = 0.8;  ///< px, 0.3…5: SD of the neighbourhood that an error has to share to count
  void validate() const;
};

/// Pixels which, held beside those that are taken, let the diffusion of fill() come closest to the frame.
/// Returns CV_8U, 255 at the anchors, which never lie on taken pixels; at most ⌊share · pixels⌋ of them,
/// fewer only where the fill is exact without more, or no pixel is left. `levels`: CV_32F, 1 or 3 channels
/// (luma counts), finite; `taken`: CV_8U of the same size; share 0…1. InputError otherwise.
///
/// The first share of them lies where |Δu| is greatest, u being smoothed a little: the best density of held
/// pixels grows with |Δu| (Belhachmi, Bucur, Burgeth & Weickert 2009, "How to choose interpolation data in
/// images"). Then in each round the frame is filled from all that is held, and the next ones are put on peaks
/// of e·(g∗e), e being the error and g a Gaussian of SD `spread`: what a pixel mends is its own error and, as
/// far as they are alike, its neighbours'. Peaks of 3 × 3 pixels only, so that the pixels keep apart; the
/// last round goes without this. Flips and quarter turns of the frame turn the anchors with it, up to ties
/// and the fill's own tolerance. With no rounds the density |Δu|^0.8 is halftoned by error diffusion instead
/// (Floyd & Steinberg 1976): much faster, some 3 dB less. O(pixels) a round; one thread.
cv::Mat choose_anchors(const cv::Mat& levels, const cv::Mat& taken, double share,
                       const AnchorOptions& options = {});

/// The same around patches as they are drawn, whose levels may differ from the frame's.
cv::Mat choose_anchors(const cv::Mat& levels, const Sketchable& drawn, double share,
                       const AnchorOptions& options = {});

}  // namespace emberfold::sketch
