// SPDX-License-Identifier: Apache-2.0
#include "tests/dytex/distances/systems.hpp"

#include <cmath>
#include <numbers>

#include "tests/support/reference_linalg.hpp"

namespace emberfold::test {

Eigen::Matrix2d pair_block(double r, double phase) {
  return r * Eigen::Matrix2d{{std::cos(phase), -std::sin(phase)}, {std::sin(phase), std::cos(phase)}};
}

Eigen::MatrixXd diagonal_of(const std::vector<Pole>& poles) {
  Eigen::Index size = 0;
  for (const Pole& pole : poles) size += pole.phase < 0 ? 1 : 2;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  Eigen::Index at = 0;
  for (const Pole& pole : poles) {
    if (pole.phase < 0) {
      result(at, at) = pole.modulus;
      ++at;
    } else {
      result.block<2, 2>(at, at) = pair_block(pole.modulus, pole.phase);
      at += 2;
    }
  }
  return result;
}

Eigen::MatrixXd basis(Eigen::Index n, std::uint64_t seed) {
  return orthonormal(n, n, seed) * Eigen::VectorXd::LinSpaced(n, 1, 3).asDiagonal() *
         orthonormal(n, n, seed + 1).transpose();
}

dytex::LinearDynamicTexture texture_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                       Eigen::Index components) {
  const Eigen::Index n = components < 0 ? A.rows() : components, frames = 5;
  dytex::LinearDynamicTexture texture;
  texture.info = {8, 7, 1, CV_8U, 25, 255, frames};
  texture.mean = Eigen::VectorXf::LinSpaced(56, 60, 200);
  texture.C = orthonormal(56, n, 11).cast<float>();
  texture.weights = Eigen::VectorXd::Ones(n);
  texture.A = A;
  texture.B = B;
  texture.states = normals(A.rows(), frames, 12);
  texture.singular = Eigen::VectorXd::LinSpaced(frames, 4, 0);
  texture.r = 2;
  return texture;
}

dytex::LinearDynamicTexture texture_with(const std::vector<Pole>& poles, std::uint64_t seed) {
  const Eigen::MatrixXd D = diagonal_of(poles), S = basis(D.rows(), seed);
  return texture_of(S * D * inverse(S), normals(D.rows(), D.rows(), seed + 7));
}

dytex::LinearDynamicTexture random_texture(Eigen::Index n, double radius, std::uint64_t seed,
                                           Eigen::Index inputs) {
  Eigen::MatrixXd A = normals(n, n, seed);
  A *= radius / dytex::spectral_radius(A);
  return texture_of(A, normals(n, inputs < 0 ? n : inputs, seed + 100));
}

Eigen::MatrixXd covariance(const dytex::LinearDynamicTexture& texture) {
  return dytex::stationary_covariance(texture.A, texture.B);
}

Eigen::MatrixXd lag_covariance(const dytex::LinearDynamicTexture& texture, int k) {
  Eigen::MatrixXd result = covariance(texture);
  for (int i = 0; i < k; ++i) result = (texture.A * result).eval();
  return result;
}

double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace emberfold::test
