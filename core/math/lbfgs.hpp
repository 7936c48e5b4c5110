// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::core::detail {

/// Returns value and gradient at a point; a value that is not finite marks a point out of bounds.
using Gradient = std::function<std::pair<double, Eigen::VectorXd>(const Eigen::VectorXd&)>;

/// Minimises a function from `start` by L-BFGS (Nocedal 1980) with backtracking (Armijo 1966).
/// The result's value never exceeds that of `start`. Stops after `most_steps`, when 10 steps together gain
/// less than `least_gain`, or when no step descends. Throws Cancelled.
Eigen::VectorXd minimize_lbfgs(const Gradient& function, Eigen::VectorXd start, int most_steps,
                               double least_gain, const core::Context& context);

}  // namespace emberfold::core::detail
