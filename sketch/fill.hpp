// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

struct FillOptions {
  double tolerance = 0.02;   ///< grey levels, > 0: RMS of the residual at which the solver stops
  int max_iterations = 100;  ///< ≥ 1
  void validate() const;
};

struct FillResult {
  cv::Mat levels;       ///< the filled frame, CV_32F, channels as given
  int iterations = 0;   ///< of the slowest channel
  double residual = 0;  ///< RMS over the filled pixels, grey levels
  bool converged = true;
};

/// Heat diffusion to equilibrium: the pixels where `mask` is 0 get the solution of Laplace's equation
/// (5-point stencil, insulated border) with the others held fixed. `levels`: CV_32F, 1 or 3 channels; `mask`:
/// CV_8U of the same size. With nothing held fixed the frame becomes 0. Conjugate gradients, preconditioned
/// by a multigrid cycle over 2×2 aggregates. O(pixels).
FillResult fill(const cv::Mat& levels, const cv::Mat& mask, const FillOptions& options = {});

}  // namespace emberfold::sketch
