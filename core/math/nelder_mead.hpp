// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Core>

namespace emberfold::core::detail {

struct Minimum {
  Eigen::VectorXd at;
  double value = 0;
};

/// Downhill simplex (Nelder & Mead 1965) from `start` and the points `steps` off it along each axis, until
/// its values lie within `tolerance` or `most` values were asked for. Infinite values are stepped back from;
/// the start's has to be finite.
Minimum minimize_nelder_mead(const std::function<double(const Eigen::VectorXd&)>& f,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& steps, double tolerance,
                             int most);

}  // namespace emberfold::core::detail
