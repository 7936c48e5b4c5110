// SPDX-License-Identifier: Apache-2.0
#include "core/math/lbfgs.hpp"

#include <cmath>
#include <limits>

#include "core/context.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct Minimum {
  Eigen::VectorXd point;
  int calls = 0;
};

Minimum minimize(const core::detail::Gradient& function, const Eigen::VectorXd& start, int steps) {
  Minimum result;
  const auto counted = [&](const Eigen::VectorXd& x) {
    ++result.calls;
    return function(x);
  };
  result.point = core::detail::minimize_lbfgs(counted, start, steps, 1e-20, {});
  return result;
}

std::pair<double, Eigen::VectorXd> banana(const Eigen::VectorXd& x) {
  const double across = x[1] - x[0] * x[0], along = 1 - x[0];
  return {100 * across * across + along * along,
          Eigen::Vector2d(-400 * across * x[0] - 2 * along, 200 * across)};
}

}  // namespace

TEST_CASE("Rosenbrock's valley is gone down in a few dozen steps") {
  const auto found = minimize(banana, Eigen::Vector2d(-1.2, 1), 80);
  CHECK_THAT(found.point[0], WithinAbs(1, 1e-6));
  CHECK_THAT(found.point[1], WithinAbs(1, 1e-6));
  CHECK(found.calls < 70);
}

TEST_CASE("A quadratic form whose curvatures differ by a factor of 2000 is minimised exactly") {
  const Eigen::Index size = 8;
  Eigen::VectorXd curvature(size), lowest(size);
  for (Eigen::Index i = 0; i < size; ++i) curvature[i] = std::pow(3.0, double(i)), lowest[i] = double(i) - 2;
  const auto form = [&](const Eigen::VectorXd& x) {
    const Eigen::VectorXd off = x - lowest, slope = curvature.cwiseProduct(off);
    return std::pair{0.5 * off.dot(slope), slope};
  };
  const auto found = minimize(form, Eigen::VectorXd::Constant(size, 10), 130);
  CHECK_THAT((found.point - lowest).cwiseAbs().maxCoeff(), WithinAbs(0, 1e-8));
  CHECK(found.calls < 200);
}

TEST_CASE("A minimum is never above its start, and points out of bounds are gone round") {
  const auto bounded = [](const Eigen::VectorXd& x) {
    const double value = x[0] <= 0 ? std::numeric_limits<double>::infinity() : x[0] - std::log(x[0]);
    return std::pair{value, Eigen::VectorXd(Eigen::VectorXd::Constant(1, 1 - 1 / x[0]))};
  };
  const auto found = minimize(bounded, Eigen::VectorXd::Constant(1, 30), 50);
  CHECK_THAT(found.point[0], WithinAbs(1, 1e-6));
  for (int steps = 0; steps < 12; ++steps) {
    const auto part = minimize(banana, Eigen::Vector2d(-1.2, 1), steps);
    CHECK(banana(part.point).first <= 24.2 + 1e-12);
  }
}
