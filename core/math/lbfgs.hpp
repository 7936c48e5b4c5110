// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::core::detail {

/// A function's value and slope at a point; a value that is not finite marks a point that is out of bounds.
using Gradient = std::function<std::pair<double, Eigen::VectorXd>(const Eigen::VectorXd&)>;

/// A low point of the function near `start`, never above it: L-BFGS with the last 10 steps and halved step
/// lengths (Armijo). Ends after `most_steps`, where 10 steps gain less than `least_gain` together, or where
/// no step goes down.
Eigen::VectorXd minimize_lbfgs(const Gradient& function, Eigen::VectorXd start, int most_steps,
                               double least_gain, const core::Context& context);

}  // namespace emberfold::core::detail
