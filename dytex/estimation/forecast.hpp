// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dytex/estimation/observations.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// The forecast of a texture, 1 … K frames ahead of a state.
struct Forecast {
  Eigen::MatrixXd states;                    ///< N × K: expected states; draw() draws a column
  std::vector<Eigen::MatrixXd> covariances;  ///< K of N × N, of the states about these
  Eigen::VectorXd error;                     ///< K: expected RMS error of a frame's values, levels
};

/// Predicts states and errors: x ← A x, P ← A P Aᵀ + B Bᵀ. The error of step k is √((tr(diag(weights)² P) + Σ
/// R)/m). Throws InputError where the texture is not valid, `from` is of another order or `steps` is outside
/// 1 … 100000. O(K N³).
Forecast forecast(const LinearDynamicTexture& texture, const StateGuess& from, int steps);

/// Returns the expected RMS error of each value, levels: √diag(C P Cᵀ + R) for the state's covariance P (N ×
/// N). CV_32F of the texture's size and channels. InputError where shapes disagree. O(m n²).
cv::Mat forecast_deviation(const LinearDynamicTexture& texture, const Eigen::MatrixXd& covariance);

}  // namespace emberfold::dytex
