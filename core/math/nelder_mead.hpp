// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

namespace emberfold::core::detail {

/// A minimum of a function.
struct Minimum {
  Eigen::VectorXd at;
  double value = 0;
};

/// Minimises a function by the downhill simplex (Nelder & Mead 1965).
/// The first simplex is `start` and the points start + steps[i] along axis i. Stops when its values are
/// within `tolerance` or after `most` evaluations. f(start) is finite; elsewhere infinite values are allowed.
Minimum minimize_nelder_mead(const std::function<double(const Eigen::VectorXd&)>& f,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& steps, double tolerance,
                             int most);

}  // namespace emberfold::core::detail
