// SPDX-License-Identifier: Apache-2.0
#include "core/math/nelder_mead.hpp"

#include <algorithm>
#include <vector>

namespace emberfold::core::detail {

Minimum minimize_nelder_mead(const std::function<double(const Eigen::VectorXd&)>& f,
                             const Eigen::VectorXd& start, const Eigen::VectorXd& steps, double tolerance,
                             int most) {
  const Eigen::Index n = start.size();
  const auto by_value = [](const Minimum& a, const Minimum& b) { return a.value < b.value; };
  std::vector<Minimum> corners{{start, f(start)}};
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd x = start;
    x[i] += steps[i];
    corners.push_back({x, f(x)});
  }
  for (int asked = static_cast<int>(n) + 1; asked < most;) {
    std::ranges::stable_sort(corners, by_value);
    Minimum& worst = corners.back();
    if (worst.value - corners.front().value < tolerance) break;
    Eigen::VectorXd middle = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) middle += corners[static_cast<std::size_t>(i)].at / double(n);
    const auto towards = [&](double share) -> Minimum {
      const Eigen::VectorXd x = middle + share * (worst.at - middle);
      ++asked;
      return {x, f(x)};
    };
    const Minimum mirrored = towards(-1);
    if (mirrored.value < corners.front().value) {
      const Minimum farther = towards(-2);
      worst = by_value(farther, mirrored) ? farther : mirrored;
    } else if (mirrored.value < corners[static_cast<std::size_t>(n) - 1].value) {
      worst = mirrored;
    } else if (const Minimum nearer = towards(mirrored.value < worst.value ? -0.5 : 0.5);
               nearer.value < std::min(mirrored.value, worst.value)) {
      worst = nearer;
    } else {
      for (std::size_t i = 1; i < corners.size(); ++i, ++asked) {
        corners[i].at = (corners[i].at + corners[0].at) / 2;
        corners[i].value = f(corners[i].at);
      }
    }
  }
  return *std::ranges::min_element(corners, by_value);
}

}  // namespace emberfold::core::detail
