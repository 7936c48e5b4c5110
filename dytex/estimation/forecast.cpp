// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "dytex/estimation/level_blocks.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

constexpr int kMostSteps = 100000;  // frames ahead

[[noreturn]] void fail_forecast(const std::string& what) {
  throw core::InputError("forecast: " + what);
}

double noise_sum(const LinearDynamicTexture& texture) {
  return texture.noise.size() > 0 ? texture.noise.cast<double>().sum()
                                  : texture.r * static_cast<double>(texture.pixels());
}

}  // namespace

Forecast forecast(const LinearDynamicTexture& texture, const StateGuess& from, int steps) {
  if (steps < 1 || steps > kMostSteps)
    fail_forecast("steps is " + std::to_string(steps) + "; allowed is 1 to " + std::to_string(kMostSteps));
  validate(texture);
  const Eigen::Index order = texture.order(), n = texture.components();
  if (from.mean.size() != order || from.factor.rows() != order)
    fail_forecast("the state has " + std::to_string(from.mean.size()) + " numbers, the texture needs " +
                  std::to_string(order));
  Forecast result;
  result.states.resize(order, steps);
  result.error.resize(steps);
  const Eigen::MatrixXd Q = texture.B * texture.B.transpose();
  const Eigen::ArrayXd shown = texture.weights.array().square();
  const double noise = noise_sum(texture);
  Eigen::VectorXd x = from.mean;
  Eigen::MatrixXd P = from.factor * from.factor.transpose();
  for (int k = 0; k < steps; ++k) {
    x = texture.A * x;
    P = texture.A * P * texture.A.transpose() + Q;
    P = ((P + P.transpose()) / 2).eval();
    result.states.col(k) = x;
    result.covariances.push_back(P);
    const double spread = (shown * P.diagonal().head(n).array()).sum();
    result.error[k] = std::sqrt((spread + noise) / static_cast<double>(texture.pixels()));
  }
  return result;
}

cv::Mat forecast_deviation(const LinearDynamicTexture& texture, const Eigen::MatrixXd& covariance) {
  const Eigen::Index order = texture.order(), n = texture.components();
  if (covariance.rows() != order || covariance.cols() != order)
    fail_forecast("the covariance is " + std::to_string(covariance.rows()) + " × " +
                  std::to_string(covariance.cols()) + ", must be " + std::to_string(order) + " × " +
                  std::to_string(order));
  const Eigen::MatrixXf factor =
      (texture.weights.asDiagonal() * detail::symmetric_factor(covariance.topLeftCorner(n, n))).cast<float>();
  const core::ClipInfo& info = texture.info;
  cv::Mat result(info.height, info.width, CV_MAKETYPE(CV_32F, info.channels));
  detail::for_sum_blocks(texture.pixels(), {}, [&](std::size_t, Eigen::Index row, Eigen::Index rows) {
    Eigen::ArrayXf variance = (texture.C.middleRows(row, rows) * factor).rowwise().squaredNorm();
    if (texture.noise.size() > 0)
      variance += texture.noise.segment(row, rows).array();
    else
      variance += static_cast<float>(texture.r);
    Eigen::Map<Eigen::ArrayXf>(result.ptr<float>() + row, rows) = variance.sqrt();
  });
  return result;
}

}  // namespace emberfold::dytex
