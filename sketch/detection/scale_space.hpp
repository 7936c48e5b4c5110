// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"

namespace emberfold::sketch {

/// Holds the symmetric 2×2 matrix of second derivatives.
struct Hessian {
  float xx = 0, xy = 0, yy = 0;
  /// Returns the second derivative along the unit vector u.
  [[nodiscard]] double along(graph::Point u) const {
    return double{xx} * u.x * u.x + 2 * double{xy} * u.x * u.y + double{yy} * u.y * u.y;
  }
};

/// Computes it from three pixels of each of three rows. Sums are ordered so that a mirrored or turned frame
/// gives the same bits.
inline Hessian hessian_of(const float* up, const float* mid, const float* down) {
  return {(mid[0] + mid[2]) - 2 * mid[1], 0.25F * ((down[2] + up[0]) - (down[0] + up[2])),
          (up[1] + down[1]) - 2 * mid[1]};
}

/// Computes the gradient by central differences.
inline graph::Point gradient_of(const float* up, const float* mid, const float* down) {
  return {0.5 * (double{mid[2]} - double{mid[0]}), 0.5 * (double{down[1]} - double{up[1]})};
}

/// Holds the image smoothed by a Gaussian; derivatives are central differences of it.
struct ScaleLevel {
  double sigma = 1;  ///< px, of the smoothing
  int channel = 0;   ///< of the frame's: luma, or the axes of opponent colours
  int octave = 0;    ///< half octaves above the channel's finest level
  cv::Mat1f frame;   ///< the image itself
  cv::Mat1f smooth;  ///< with a border of one pixel, so that every pixel of the frame has eight neighbours
  double gradient_sd = 0;  ///< SD of a first derivative under white noise of SD 1
  double hessian_sd = 0;   ///< SD of a second derivative (xx or yy) under white noise of SD 1

  [[nodiscard]] Hessian hessian(int x, int y) const {
    return hessian_of(smooth[y] + x, smooth[y + 1] + x, smooth[y + 2] + x);
  }
  [[nodiscard]] graph::Point gradient(int x, int y) const {
    return gradient_of(smooth[y] + x, smooth[y + 1] + x, smooth[y + 2] + x);
  }
  /// Returns the Hessian at a place, bilinear between pixels, clamped to the frame.
  [[nodiscard]] Hessian hessian_at(graph::Point p) const;
  /// Returns the smoothed level at a place, likewise.
  [[nodiscard]] double value_at(graph::Point p) const;
};

/// Levels of one channel from fine to coarse, those of the next channel after them.
using ScaleSpace = std::vector<ScaleLevel>;

/// Returns the finest level of the channel that level k belongs to.
inline const ScaleLevel& finest_level(const ScaleSpace& space, std::size_t k) {
  return space[k - static_cast<std::size_t>(space[k].octave)];
}

/// Builds levels at finest, finest·√2, finest·2, … px. Each is smoothed from the one before, with taps as far
/// apart as the smoothness reached allows (at most 1e-5 of the amplitude is lost). Mirrored frames give
/// mirrored levels, bit by bit. O(pixels · levels).
ScaleSpace scale_space(const cv::Mat1f& luma, double finest, int levels, int channel = 0);

/// Returns a scale space of one channel with a level at 1/√2 of its finest and `more` coarser ones; those
/// that it has are shared.
ScaleSpace with_more_levels(ScaleSpace space, int more);

}  // namespace emberfold::sketch
