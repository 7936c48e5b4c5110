// SPDX-License-Identifier: Apache-2.0
#include "dytex/linear_dynamic_texture.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <opencv2/core/hal/interface.h>

#include "core/error.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

constexpr int kMostSide = 65536;    // px
constexpr int kMostDoublings = 64;  // 2^64 frames: what has not converged by then does not

[[noreturn]] void fail(const std::string& what) {
  throw core::InputError("texture: " + what);
}

std::string shape_text(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " × " + std::to_string(columns);
}

template <class Matrix>
void check(const char* name, const Matrix& matrix, Eigen::Index rows, Eigen::Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns)
    fail(std::string(name) + " is " + shape_text(matrix.rows(), matrix.cols()) + ", must be " +
         shape_text(rows, columns));
  if (!matrix.allFinite()) fail(std::string(name) + " has a value that is not finite");
}

void check_info(const core::ClipInfo& info) {
  for (const auto& [name, value] : {std::pair{"width", info.width}, {"height", info.height}}) {
    if (value < 1 || value > kMostSide)
      fail(std::string(name) + " is " + std::to_string(value) + "; allowed is 1 to 65536");
  }
  if (info.channels != 1 && info.channels != 3)
    fail("channels is " + std::to_string(info.channels) + "; allowed is 1 or 3");
  if (info.depth != CV_8U && info.depth != CV_16U && info.depth != CV_32F)
    fail("depth is " + std::to_string(info.depth) + "; allowed is CV_8U, CV_16U or CV_32F");
  for (const auto& [name, value] : {std::pair{"fps", info.fps}, {"white", info.white}}) {
    if (!(value > 0) || !std::isfinite(value))
      fail(std::string(name) + " is " + std::to_string(value) + ", must be positive and finite");
  }
  if (!info.frames || *info.frames < 1) fail("frames must be 1 or more");
}

void check_noise_share(const LinearDynamicTexture& texture) {
  if (!(texture.noise_share > 0 && texture.noise_share <= 1))
    fail("noise_share is " + std::to_string(texture.noise_share) + ", must be above 0 and at most 1");
}

}  // namespace

void validate(const LinearDynamicTexture& texture) {
  check_info(texture.info);
  const Eigen::Index n = texture.components(), order = texture.order(), inputs = texture.B.cols(),
                     frames = *texture.info.frames;
  const Eigen::Index m = Eigen::Index{texture.info.width} * texture.info.height * texture.info.channels;
  check("mean", texture.mean, m, 1);
  check("A", texture.A, order, order);
  check("C", texture.C, m, n);
  if (order < n || (n == 0 && order > 0))
    fail("A is " + shape_text(order, order) + " for " + std::to_string(n) + " components, must be " +
         (n == 0 ? "0 × 0" : "at least " + shape_text(n, n)));
  check("weights", texture.weights, n, 1);
  check("B", texture.B, order, inputs);
  if (inputs > order)
    fail("B is " + shape_text(order, inputs) + ", must have at most " + std::to_string(order) + " columns");
  check("states", texture.states, order, frames);
  if (texture.noise.size() > 0) check("noise", texture.noise, m, 1);
  if (!(texture.noise.array() >= 0).all()) fail("noise has a negative value");
  check_noise_share(texture);
  check("singular", texture.singular, frames, 1);
  if (!(texture.r >= 0) || !std::isfinite(texture.r))
    fail("r is " + std::to_string(texture.r) + ", must be finite and at least 0");
  if (!(texture.singular.array() >= 0).all()) fail("singular has a negative value");
  if (const double radius = spectral_radius(texture.A); !(radius < 1))
    fail("A has the spectral radius " + std::to_string(radius) + ", must be below 1");
}

double spectral_radius(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  if (matrix.rows() != matrix.cols())
    throw core::InputError("spectral_radius: the matrix is " + shape_text(matrix.rows(), matrix.cols()) +
                           ", must be square");
  if (matrix.size() == 0) return 0;
  if (!matrix.allFinite())
    throw core::InputError("spectral_radius: the matrix has a value that is not finite");
  return detail::largest_absolute_eigenvalue(matrix);
}

Eigen::MatrixXd stationary_covariance(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                      const Eigen::Ref<const Eigen::MatrixXd>& B) {
  Eigen::MatrixXd covariance = B * B.transpose(), power = A;
  for (int step = 0; step < kMostDoublings && covariance.allFinite(); ++step) {
    const Eigen::MatrixXd more = power * covariance * power.transpose();
    covariance += more;
    power = (power * power).eval();
    const double size = covariance.norm();
    if (std::isfinite(size) && more.norm() <= std::numeric_limits<double>::epsilon() * size)
      return (covariance + covariance.transpose()) / 2;
  }
  throw core::NumericalError("stationary_covariance: the states have none, A is not stable");
}

Eigen::VectorXd expected_state(const LinearDynamicTexture& texture,
                               const Eigen::Ref<const Eigen::VectorXd>& shown) {
  const Eigen::Index n = texture.components(), order = texture.order();
  if (shown.size() != n)
    throw core::InputError("the state has " + std::to_string(shown.size()) + " numbers, the texture shows " +
                           std::to_string(n));
  if (order == n) return shown;
  const Eigen::MatrixXd covariance = stationary_covariance(texture.A, texture.B);
  const detail::SymmetricEigen eigen = detail::symmetric_eigen(covariance.topLeftCorner(n, n));
  // Pseudo-inverse: directions of zero variance are dropped.
  const double least = eigen.values[0] * static_cast<double>(n) * std::numeric_limits<double>::epsilon();
  const Eigen::ArrayXd inverse = (eigen.values.array() > least).select(eigen.values.array().inverse(), 0);
  Eigen::VectorXd state(order);
  state.head(n) = shown;
  state.tail(order - n) = covariance.bottomLeftCorner(order - n, n) *
                          (eigen.vectors * (inverse * (eigen.vectors.transpose() * shown).array()).matrix());
  return state;
}

}  // namespace emberfold::dytex
