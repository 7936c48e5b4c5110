// SPDX-License-Identifier: Apache-2.0
#include "core/math/nelder_mead.hpp"

#include <cmath>
#include <limits>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("The simplex finds the bottom of a bent valley and stays out of the infinite", "[nelder_mead]") {
  const auto valley = [](const Eigen::VectorXd& x) {
    if (x[0] < -1.5) return std::numeric_limits<double>::infinity();
    return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2);
  };
  const auto found = core::detail::minimize_nelder_mead(valley, Eigen::Vector2d(-1.2, 1),
                                                        Eigen::Vector2d(0.5, 0.5), 1e-14, 1000);
  CHECK_THAT(found.at[0], Catch::Matchers::WithinAbs(1, 1e-4));
  CHECK_THAT(found.at[1], Catch::Matchers::WithinAbs(1, 1e-4));
  int asked = 0;
  (void)core::detail::minimize_nelder_mead([&](const Eigen::VectorXd& x) { return ++asked, valley(x); },
                                           Eigen::Vector2d(-1.2, 1), Eigen::Vector2d(0.5, 0.5), 0, 60);
  CHECK(asked >= 60);
  CHECK(asked < 65);
}
