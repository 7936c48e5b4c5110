// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

/// Holds when the solver of fill() stops.
struct FillOptions {
  double tolerance = 0.03;   ///< grey levels, > 0: estimate of the largest error
  int max_iterations = 100;  ///< ≥ 1
  /// Throws core::InputError naming field, value and range.
  void validate() const;
};

/// Holds a filled frame and how the solver ended.
struct FillResult {
  cv::Mat levels;      ///< the filled frame, CV_32F, channels as given
  int iterations = 0;  ///< of the slowest channel
  double error = 0;    ///< estimate of the largest error, grey levels
  bool converged = true;
};

/// Fills the pixels where `mask` is 0 by heat diffusion to equilibrium. They get the solution of Laplace's
/// equation (5-point stencil, insulated border) with the other pixels held, which come back untouched.
/// `levels`: CV_32F, 1 or 3 channels, finite where held, anything elsewhere; `mask`: CV_8U, 1 channel, of the
/// same size; throws core::InputError otherwise. With nothing held the frame becomes 0. Conjugate gradients,
/// preconditioned by a multigrid cycle over 2×2 aggregates. O(pixels); one thread.
FillResult fill(const cv::Mat& levels, const cv::Mat& mask, const FillOptions& options = {});

/// Puts held pixels onto a background without a seam. Returns background + u, u being the difference of the
/// held pixels from the background and, elsewhere, the solution of (Δ − 1/reach²) u = 0 (5-point stencil,
/// insulated border). Beside the held pixels the background takes their level; some `reach` px away it is
/// itself again, and its texture is kept everywhere. `background`: of the levels' size and type, finite;
/// reach: 1…10⁴ px; the rest, and the errors, as for fill(). With nothing held the frame is the background.
FillResult fill_onto(const cv::Mat& levels, const cv::Mat& mask, const cv::Mat& background, double reach);

}  // namespace emberfold::sketch
