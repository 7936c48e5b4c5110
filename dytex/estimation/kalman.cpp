// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/kalman.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kSteadyTolerance = 1e-12;  // relative change of a covariance below which it is kept

[[noreturn]] void fail_filter(const std::string& what) {
  throw core::InputError("filter: " + what);
}

template <class Matrix>
void check(const char* name, const Matrix& matrix, Eigen::Index rows, Eigen::Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns)
    fail_filter(std::string(name) + " is " + std::to_string(matrix.rows()) + " × " +
                std::to_string(matrix.cols()) + ", must be " + std::to_string(rows) + " × " +
                std::to_string(columns));
  if (!matrix.allFinite()) fail_filter(std::string(name) + " has a value that is not finite");
}

void check(const StateSpace& space) {
  const Eigen::Index n = space.A.rows();
  check("A", space.A, n, n);
  check("B", space.B, n, space.B.cols());
  check("first", space.first, n, 1);
  check("first_factor", space.first_factor, n, space.first_factor.cols());
}

void check(const Observations& seen, Eigen::Index n) {
  const Eigen::Index frames = seen.frames();
  if (frames < 1) fail_filter("there is no frame");
  check("vectors", seen.vectors, n, frames);
  check("squares", seen.squares, frames, 1);
  check("constants", seen.constants, frames, 1);
  for (const Eigen::MatrixXd& information : seen.information) check("information", information, n, n);
  if (seen.which.size() != static_cast<std::size_t>(frames))
    fail_filter("which has " + std::to_string(seen.which.size()) + " entries, must have " +
                std::to_string(frames));
  for (const int which : seen.which)
    if (which < -1 || which >= static_cast<int>(seen.information.size()))
      fail_filter("which is " + std::to_string(which) + "; allowed is -1 to " +
                  std::to_string(static_cast<int>(seen.information.size()) - 1));
}

/// The filtered factor and the volume of a step whose predicted factor is known.
void take_frame(const Eigen::MatrixXd* information, FilterStep& step) {
  const Eigen::MatrixXd& F = step.predicted;
  if (information == nullptr || F.cols() == 0) {
    step.filtered = F;
    return;
  }
  Eigen::MatrixXd M = F.transpose() * (information->selfadjointView<Eigen::Lower>() * F);
  M.diagonal().array() += 1;
  const detail::CholeskyFactors factors(M);
  if (!factors.positive()) throw core::NumericalError("filter: the frames' precision is out of range");
  step.filtered = factors.right_divide_upper(F);
  step.log_volume = factors.log_determinant();
}

/// F with F Fᵀ = A P Aᵀ + B Bᵀ.
Eigen::MatrixXd advance(const StateSpace& space, const Eigen::MatrixXd& factor) {
  Eigen::MatrixXd rows(factor.cols() + space.B.cols(), space.A.rows());
  rows << (space.A * factor).transpose(), space.B.transpose();
  return detail::triangular_factor(rows).transpose();
}

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix) {
  return (matrix + matrix.transpose()) / 2;
}

bool nearly_same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() <= kSteadyTolerance * a.norm();
}

/// Keeps the covariance of the last frame where this one would have the same.
class Steps {
 public:
  Steps(const StateSpace& space, const Observations& seen, Filtered& result)
      : space_(space), seen_(seen), result_(result) {}

  const FilterStep& at(Eigen::Index t) {
    const int which = seen_.which[static_cast<std::size_t>(t)];
    const bool like_last = t > 0 && which == last_which_;
    if (!(steady_ && like_last)) {
      FilterStep step;
      step.predicted = t == 0 ? space_.first_factor : advance(space_, result_.steps.back().filtered);
      take_frame(which < 0 ? nullptr : &seen_.information[static_cast<std::size_t>(which)], step);
      Eigen::MatrixXd covariance = step.predicted * step.predicted.transpose();
      steady_ = like_last && nearly_same(covariance, covariance_);
      covariance_ = std::move(covariance);
      if (!steady_) result_.steps.push_back(std::move(step));
    }
    last_which_ = which;
    result_.step.push_back(static_cast<int>(result_.steps.size()) - 1);
    return result_.steps.back();
  }

 private:
  const StateSpace& space_;
  const Observations& seen_;
  Filtered& result_;
  Eigen::MatrixXd covariance_;
  int last_which_ = -1;
  bool steady_ = false;
};

/// J with J (F Fᵀ) = P Aᵀ.
Eigen::MatrixXd smoother_gain(const StateSpace& space, const Eigen::MatrixXd& filtered,
                              const Eigen::MatrixXd& predicted) {
  if (predicted.cols() == 0) return Eigen::MatrixXd::Zero(predicted.rows(), predicted.rows());
  const Eigen::MatrixXd cross = space.A * filtered * filtered.transpose();
  const Eigen::VectorXd diagonal = predicted.diagonal().cwiseAbs();
  const double least = static_cast<double>(predicted.rows()) * std::numeric_limits<double>::epsilon();
  if (predicted.rows() == predicted.cols() && diagonal.minCoeff() > least * diagonal.maxCoeff()) {
    const auto lower = predicted.triangularView<Eigen::Lower>();
    return lower.transpose().solve(lower.solve(cross)).transpose();
  }
  const detail::SymmetricEigen eigen = detail::symmetric_eigen(predicted * predicted.transpose());
  const double smallest = eigen.values.size() > 0 ? least * eigen.values[0] : 0;
  const Eigen::VectorXd inverse =
      (eigen.values.array() > smallest)
          .select(eigen.values.cwiseInverse(), Eigen::VectorXd::Zero(eigen.values.size()));
  return (eigen.vectors * (inverse.asDiagonal() * (eigen.vectors.transpose() * cross))).transpose();
}

}  // namespace

Filtered filter(const StateSpace& space, const Observations& seen) {
  check(space);
  check(seen, space.A.rows());
  const Eigen::Index n = space.A.rows(), frames = seen.frames();
  Filtered result;
  result.predicted.resize(n, frames);
  result.states.resize(n, frames);
  Steps steps(space, seen, result);
  Eigen::VectorXd x = space.first;
  for (Eigen::Index t = 0; t < frames; ++t) {
    result.predicted.col(t) = x;
    const FilterStep& step = steps.at(t);
    if (const int which = seen.which[static_cast<std::size_t>(t)]; which >= 0) {
      const auto h = seen.vectors.col(t);
      const Eigen::VectorXd g = h - seen.information[static_cast<std::size_t>(which)] * x;
      const Eigen::VectorXd white = step.filtered.transpose() * g;
      const double distance = seen.squares[t] - x.dot(h) - x.dot(g) - white.squaredNorm();
      result.log_likelihood -= (seen.constants[t] + step.log_volume + distance) / 2;
      x += step.filtered * white;
    }
    result.states.col(t) = x;
    x = space.A * x;
  }
  if (!std::isfinite(result.log_likelihood) || !result.states.allFinite())
    throw core::NumericalError("filter: the states leave the range of numbers");
  return result;
}

Smoothed smooth(const StateSpace& space, const Filtered& filtered) {
  const Eigen::Index n = space.A.rows(), frames = filtered.states.cols();
  if (filtered.states.rows() != n || frames < 1 || filtered.step.size() != static_cast<std::size_t>(frames))
    throw core::InputError("smooth: the filter's result is of another state space");
  const auto filter_step = [&](Eigen::Index t) { return filtered.step[static_cast<std::size_t>(t)]; };
  const auto factors = [&](Eigen::Index t) -> const FilterStep& {
    return filtered.steps[static_cast<std::size_t>(filter_step(t))];
  };
  Smoothed result;
  result.states = filtered.states;
  result.step.resize(static_cast<std::size_t>(frames));
  const Eigen::MatrixXd Q = space.B * space.B.transpose();
  const Eigen::MatrixXd& last = factors(frames - 1).filtered;
  result.steps.push_back({symmetric(last * last.transpose()), {}});
  result.step.back() = 0;
  Eigen::MatrixXd J, rest;  // rest: the filtered covariance that remains with x(t+1) known
  std::pair<int, int> of{-1, -1};
  bool steady = false;
  for (Eigen::Index t = frames - 2; t >= 0; --t) {
    const std::pair<int, int> pair{filter_step(t), filter_step(t + 1)};
    const bool like_next = pair == of;
    if (!like_next) {
      of = pair;
      J = smoother_gain(space, factors(t).filtered, factors(t + 1).predicted);
      const Eigen::MatrixXd left = factors(t).filtered - J * (space.A * factors(t).filtered);
      rest = left * left.transpose() + J * Q * J.transpose();
    }
    result.states.col(t) += J * (result.states.col(t + 1) - filtered.predicted.col(t + 1));
    if (!(steady && like_next)) {
      const Eigen::MatrixXd& next = result.steps.back().covariance;
      SmootherStep step{{}, next * J.transpose()};
      step.covariance = symmetric(rest + J * step.with_next);
      steady = like_next && nearly_same(step.covariance, next);
      if (!steady) result.steps.push_back(std::move(step));
    }
    result.step[static_cast<std::size_t>(t)] = static_cast<int>(result.steps.size()) - 1;
  }
  return result;
}

}  // namespace emberfold::dytex
