// SPDX-License-Identifier: Apache-2.0
// The singular values, apart from the other decompositions: Eigen's divide and conquer takes as long to
// compile as all others.
#include <algorithm>
#include <limits>

#include <Eigen/QR>
#include <Eigen/SVD>

#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

Eigen::MatrixXd left_factor(const Eigen::MatrixXd& matrix) {
  const Eigen::Index rows = matrix.rows(), columns = matrix.cols();
  if (matrix.size() == 0) return Eigen::MatrixXd(rows, 0);
  Eigen::MatrixXd small = matrix;
  if (columns > rows) {  // M = Rᵀ Qᵀ: the left half is Rᵀ's
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix.transpose());
    small = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>().toDenseMatrix().transpose();
  }
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(small, Eigen::ComputeThinU);
  const Eigen::VectorXd& s = svd.singularValues();
  const double least =
      s[0] * static_cast<double>(std::max(rows, columns)) * std::numeric_limits<double>::epsilon();
  const Eigen::Index kept = (s.array() > least).count();
  return svd.matrixU().leftCols(kept) * s.head(kept).asDiagonal();
}

ThinSvd thin_svd(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {Eigen::MatrixXd(matrix.rows(), 0), Eigen::MatrixXd(matrix.cols(), 0), {}};
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  return Eigen::BDCSVD<Eigen::MatrixXd>(matrix).singularValues();
}

SingularVectors singular_vectors(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0)
    return {Eigen::MatrixXd::Identity(matrix.rows(), matrix.rows()), Eigen::MatrixXd(matrix.cols(), 0)};
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.matrixV()};
}

}  // namespace emberfold::dytex::detail
