// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "sketch/texture/texture_regions.hpp"

namespace emberfold::sketch {

/// Holds the settings of efros_leung().
struct EfrosLeungOptions {
  int window = 9;           ///< px, odd, 3…31: side of the squares that are compared
  double tolerance = 0.1;   ///< ≥ 0: share by which a drawn candidate may be worse than the best
  int candidates = 400;     ///< 1…100000: places compared, beside those that neighbours came from
  double guidance = 0.002;  ///< 0…1: weight of pixels that are not drawn yet
  std::uint64_t seed = 1;
  void validate() const;
};

/// Holds a drawn frame and the origin of its pixels.
struct EfrosLeungResult {
  cv::Mat levels;  ///< CV_32F, channels as given
  cv::Mat source;  ///< CV_32SC2: (x, y) of the pixel that a free one is a copy of, else (−1, −1)
};

/// Draws the free pixels (those with a label) as copies of observed pixels with similar surroundings (Efros &
/// Leung 1999). Pixels are drawn one by one, outwards from the held ones. Squares are compared by
/// Gaussian-weighted squared differences over all channels, and one of the candidates within 1 + tolerance of
/// the best is drawn. A pixel comes from its own region and, so that the frame is not merely copied in place,
/// from more than half a window away; where a region has no such pixel, from anywhere outside the strokes,
/// and as a last resort from its own place.
///
/// Efros & Leung compare with every place. Here the candidates are the places that carry on the neighbours'
/// copies (Ashikhmin 2001) and `candidates` others, half of them drawn from places of about the same mean,
/// half from the whole region. Two things keep errors from growing: pixels with the most known neighbours
/// come first, and pixels that are not drawn yet count a little with the level of `start` (`guidance`).
///
/// `start`: held pixels and the diffusion between them; `observed`: the frame. Both CV_32F, 1 or 3 channels,
/// finite, of the labels' size; throws core::InputError otherwise. Held pixels come back bit for bit; with
/// none held the texture grows from a copied patch in the middle. Random numbers depend on (seed, pixel). One
/// thread; O(free pixels · candidates · window²) at most; progress as "efros-leung". Throws core::Cancelled.
EfrosLeungResult efros_leung(const cv::Mat& start, const cv::Mat& observed, const TextureRegions& regions,
                             const EfrosLeungOptions& options = {}, const core::Context& context = {});

}  // namespace emberfold::sketch
