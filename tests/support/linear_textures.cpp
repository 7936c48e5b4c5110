// SPDX-License-Identifier: Apache-2.0
#include "tests/support/linear_textures.hpp"

namespace emberfold::test {

dytex::LinearDynamicTexture made_texture(int width, int height, Eigen::Index components, std::uint64_t seed,
                                         double radius, Eigen::Index order) {
  const Eigen::Index m = Eigen::Index{width} * height, n = components, N = order > 0 ? order : n;
  constexpr int kFrames = 5;
  dytex::LinearDynamicTexture texture;
  texture.info = {width, height, 1, CV_8U, 25, 255, kFrames};
  texture.mean = (100 + 3 * normals(m, 1, 10 * seed).array()).cast<float>();
  texture.C = n > 0 ? orthonormal(m, n, 10 * seed + 1).cast<float>() : Eigen::MatrixXf(m, 0);
  texture.weights = Eigen::VectorXd::Ones(n);
  texture.A = normals(N, N, 10 * seed + 2);
  if (N > 0) texture.A *= radius / dytex::spectral_radius(texture.A);
  texture.B = 2 * normals(N, N, 10 * seed + 3);
  texture.r = 1.5;
  texture.states = normals(N, kFrames, 10 * seed + 4);
  texture.singular = Eigen::VectorXd::LinSpaced(kFrames, 5, 1);
  return texture;
}

dytex::LinearDynamicTexture in_other_coordinates(dytex::LinearDynamicTexture texture) {
  const Eigen::Index n = texture.order();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) turn(i, n - 1 - i) = i % 2 == 0 ? 1 : -1;
  texture.C = (texture.C * turn.cast<float>().transpose()).eval();
  texture.weights = (turn.cwiseAbs() * texture.weights).eval();
  texture.A = (turn * texture.A * turn.transpose()).eval();
  texture.B = (turn * texture.B).eval();
  texture.states = (turn * texture.states).eval();
  return texture;
}

Eigen::MatrixXd whole_C(const dytex::LinearDynamicTexture& texture) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(texture.pixels(), texture.order());
  C.leftCols(texture.components()) = texture.C.cast<double>() * texture.weights.asDiagonal();
  return C;
}

}  // namespace emberfold::test
