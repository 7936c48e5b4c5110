// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

struct FillOptions {
  double tolerance = 0.03;   ///< grey levels, > 0: the solver stops when it thinks no pixel further off
  int max_iterations = 100;  ///< ≥ 1
  void validate() const;
};

struct FillResult {
  cv::Mat levels;      ///< the filled frame, CV_32F, channels as given
  int iterations = 0;  ///< of the slowest channel
  double error = 0;    ///< estimate of the largest error, grey levels; the true one is of that size
  bool converged = true;
};

/// Heat diffusion to equilibrium: the pixels where `mask` is 0 get the solution of Laplace's equation
/// (5-point stencil, insulated border) with the others held fixed; those come back untouched. `levels`:
/// CV_32F, 1 or 3 channels, finite where held, anything elsewhere; `mask`: CV_8U, 1 channel, of the same
/// size; InputError otherwise. With nothing held fixed the frame becomes 0. Conjugate gradients,
/// preconditioned by a multigrid cycle over 2×2 aggregates. O(pixels); one thread.
FillResult fill(const cv::Mat& levels, const cv::Mat& mask, const FillOptions& options = {});

/// Puts what is held onto a ground without a seam: ground + u, u being what the held pixels differ from the
/// ground and, elsewhere, the solution of (Δ − 1/reach²) u = 0 (5-point stencil, insulated border). So the
/// ground takes the held pixels' level beside them and is itself again some `reach` px away, its own texture
/// kept everywhere. `ground`: of the levels' size and type, finite; reach: 1…10⁴ px; the rest, and
/// what is refused, as for fill(). With nothing held the frame is the ground.
FillResult fill_onto(const cv::Mat& levels, const cv::Mat& mask, const cv::Mat& background, double reach,
                     const FillOptions& options = {});

}  // namespace emberfold::sketch
