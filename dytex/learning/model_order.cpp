// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/model_order.hpp"

#include <algorithm>
#include <limits>

#include "core/error.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr Eigen::Index kLeastFrames = 10;    // of a clip of which a fifth is held out
constexpr Eigen::Index kEachOrderUpTo = 60;  // components; above, orders grow by 1 / kOrdersPerStep
constexpr Eigen::Index kOrdersPerStep = 20;
// Coefficients of eq. 5 of Gavish, Donoho 2014, from the cube down.
constexpr double kOmega[] = {0.56, -0.95, 1.82, 1.43};

/// Finds the spectrum of a centred Gram matrix. `size`: the raw matrix's largest entry, which scales rounding
/// errors.
Spectrum centred_spectrum(const Eigen::MatrixXd& centred, double size, double to_levels,
                          Eigen::Index values) {
  const Eigen::Index frames = centred.rows();
  SymmetricEigen eigen = symmetric_eigen(centred);
  // Rounding error of an eigenvalue of 0: the entries' errors, times τ.
  const double least = 8 * static_cast<double>(frames) * std::numeric_limits<double>::epsilon() * size;
  const Eigen::Index rank = std::min({(eigen.values.array() > least).count(), frames - 1, values});
  eigen.values.tail(frames - rank).setZero();
  return {to_levels * eigen.values.cwiseSqrt(), eigen.vectors.leftCols(rank)};
}

/// Returns ‖x(t+1) − A x(t)‖² summed over the frames after the first `trained`, for n components.
double state_error(const Spectrum& found, const Eigen::MatrixXd& seen, Eigen::Index n) {
  const Eigen::Index trained = found.V.rows(), gaps = seen.cols() - 1;
  const auto V = found.V.leftCols(n);
  const Eigen::MatrixXd gamma = V.bottomRows(trained - 1).transpose() * V.topRows(trained - 1);
  const Eigen::VectorXd last = V.row(trained - 1).transpose();
  // The least-squares fit, as in dynamics.cpp; in states of unit size.
  const Eigen::MatrixXd A = gamma + (gamma * last) * last.transpose() / (1 - last.squaredNorm());
  const Eigen::MatrixXd error = seen.topRightCorner(n, gaps) - A * seen.topLeftCorner(n, gaps);
  return (found.singular.head(n).asDiagonal() * error).squaredNorm();
}

}  // namespace

Spectrum spectrum(const Eigen::MatrixXd& gram, double to_levels, Eigen::Index values) {
  if (!gram.triangularView<Eigen::Lower>().toDenseMatrix().allFinite())
    throw core::InputError("the clip has a value that is not finite");
  return centred_spectrum(centred(gram), gram.diagonal().cwiseAbs().maxCoeff(), to_levels, values);
}

Eigen::Index gavish_donoho(const Eigen::Ref<const Eigen::VectorXd>& singular, Eigen::Index values) {
  const Eigen::Index count = std::min(singular.size() - 1, values);
  if (count < 1) return 0;
  const double beta = static_cast<double>(count) / static_cast<double>(std::max(singular.size() - 1, values));
  const double omega =
      kOmega[0] * beta * beta * beta + kOmega[1] * beta * beta + kOmega[2] * beta + kOmega[3];
  const double median = (singular[(count - 1) / 2] + singular[count / 2]) / 2;
  return (singular.head(count).array() > omega * median).count();
}

std::vector<std::pair<int, double>> held_out_errors(const Eigen::MatrixXd& gram, double to_levels,
                                                    Eigen::Index values) {
  const Eigen::Index frames = gram.rows(), trained = frames - frames / 5, gaps = frames - trained;
  if (frames < kLeastFrames) return {};
  const Eigen::MatrixXd products = centred(gram, trained) * (to_levels * to_levels);
  const Spectrum found =
      centred_spectrum(products.topLeftCorner(trained, trained),
                       gram.diagonal().cwiseAbs().maxCoeff() * to_levels * to_levels, 1, values);
  const Eigen::VectorXd inverse = found.singular.head(found.rank()).cwiseInverse();
  // States of the last trained frame and those after it, over S: S⁻² Vᵀ Yᵀ y.
  const Eigen::MatrixXd seen =
      inverse.cwiseAbs2().asDiagonal() * (found.V.transpose() * products.topRightCorner(trained, gaps + 1));
  const double frame_squares = products.diagonal().tail(gaps).sum();
  std::vector<std::pair<int, double>> errors;
  double shown_squares = 0;
  Eigen::Index counted = 0;
  for (Eigen::Index n = 1; n <= std::min(found.rank(), trained - 2);
       n += n < kEachOrderUpTo ? 1 : std::max<Eigen::Index>(n / kOrdersPerStep, 1)) {
    for (; counted < n; ++counted)
      shown_squares += (found.singular[counted] * seen.row(counted).tail(gaps)).squaredNorm();
    const double error = frame_squares - shown_squares + state_error(found, seen, n);
    errors.emplace_back(static_cast<int>(n),
                        error / (static_cast<double>(gaps) * static_cast<double>(values)));
  }
  return errors;
}

}  // namespace emberfold::dytex::detail
