// SPDX-License-Identifier: Apache-2.0
#include "tests/dytex/estimation/em_make.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "tests/support/reference_linalg.hpp"

namespace emberfold::test {

PlainStep plain_em_step(const DenseGaussian& known, const Look& look, const Eigen::MatrixXd& Y,
                        const Eigen::MatrixXd& seen, bool noise_per_value, bool with_mean) {
  const Eigen::Index n = known.states.rows(), frames = Y.cols(), m = Y.rows();
  Eigen::MatrixXd S00 = Eigen::MatrixXd::Zero(n, n), S11 = S00, S10 = S00;
  for (Eigen::Index t = 0; t + 1 < frames; ++t) {
    S00 += known.moment(t, t);
    S11 += known.moment(t + 1, t + 1);
    S10 += known.moment(t + 1, t);
  }
  PlainStep step;
  step.space.A = S10 * inverse(S00);
  step.Q = (S11 - step.space.A * S10.transpose()) / static_cast<double>(frames - 1);
  step.space.B = cholesky_factor((step.Q + step.Q.transpose()) / 2);
  step.space.first = known.states.col(0);
  step.first_covariance = known.block(0, 0);
  step.space.first_factor = cholesky_factor(step.first_covariance);
  step.look = look;
  double left = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index size = n + (with_mean ? 1 : 0);
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
    double squares = 0, count = 0;
    for (Eigen::Index t = 0; t < frames; ++t) {
      if (seen(i, t) == 0) continue;
      Eigen::VectorXd z = Eigen::VectorXd::Ones(size);
      z.head(n) = known.states.col(t);
      S += z * z.transpose();
      S.topLeftCorner(n, n) += known.block(t, t);
      const double y = Y(i, t) - look.mean[i];
      b += y * z;
      squares += y * y;
      count += 1;
    }
    if (count == 0) continue;
    const Eigen::VectorXd weights = solve_positive(S, b);
    step.look.C.row(i) = weights.head(n).transpose();
    if (with_mean) step.look.mean[i] += weights[n];
    const double rest = squares - weights.dot(b);
    step.look.noise[i] = rest / count;
    left += rest;
  }
  if (!noise_per_value) step.look.noise.setConstant(left / seen.sum());
  return step;
}

KnownClip known_clip(Eigen::Index m, Eigen::Index frames, double r, std::uint64_t seed, double strength) {
  constexpr std::array<std::pair<double, double>, 2> kTurns{{{0.97, 0.25}, {0.92, 0.9}}};
  KnownClip made;
  made.r = r;
  made.A = Eigen::MatrixXd::Zero(4, 4);
  for (int i = 0; i < 2; ++i) {
    const auto [size, angle] = kTurns[static_cast<std::size_t>(i)];
    made.A.block<2, 2>(2 * i, 2 * i) << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    made.A.block<2, 2>(2 * i, 2 * i) *= size;
  }
  made.C = orthonormal(m, 4, seed);
  const Eigen::VectorXd drive = strength * Eigen::Vector4d(1, 0.9, 0.8, 0.7);
  const Eigen::MatrixXd noise = normals(4, frames + 200, seed + 1);
  made.states.resize(4, frames);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(4);
  for (Eigen::Index t = -200; t < frames; ++t) {
    x = made.A * x + drive.cwiseProduct(noise.col(t + 200));
    if (t >= 0) made.states.col(t) = x;
  }
  made.clean = ((made.C * made.states).array() + 128).matrix();
  made.levels = made.clean + std::sqrt(r) * normals(m, frames, seed + 2);
  return made;
}

dytex::Missing missing_of(const core::Clip& mask, const core::ClipInfo& info) {
  core::ClipSource source(mask);
  return dytex::Missing(source, info);
}

}  // namespace emberfold::test
