// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// Matrices side by side, all with the same rows.
using SideBySide = std::vector<const Eigen::MatrixXf*>;

/// Adds MᵀM to `sum` (K × K, lower half), M having K columns in all. In double, in a fixed order: the same
/// bits at any thread count. O(rows K²).
void add_stripe_products(const SideBySide& columns, Eigen::MatrixXd& sum, const core::Context& context);

/// Returns M · right (K × n) in double, rounded at the end. O(rows K n).
Eigen::MatrixXf product(const SideBySide& columns, const Eigen::MatrixXd& right,
                        const core::Context& context);

}  // namespace emberfold::dytex::detail
