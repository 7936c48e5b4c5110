// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <vector>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/linear_textures.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using dytex::LinearDynamicTexture;

/// One value that an auto-regression with these poles moves; its state holds the last values.
LinearDynamicTexture auto_regression(const std::vector<std::complex<double>>& poles) {
  std::vector<std::complex<double>> polynomial{1};
  for (const auto& pole : poles) {
    polynomial.push_back(0);
    for (std::size_t i = polynomial.size() - 1; i > 0; --i) polynomial[i] -= pole * polynomial[i - 1];
  }
  const auto order = static_cast<Eigen::Index>(poles.size());
  LinearDynamicTexture texture = made_texture(1, 1, 1, 1, 0.5, order);
  texture.C(0, 0) = 1;
  texture.A.setZero();
  for (Eigen::Index i = 0; i < order; ++i)
    texture.A(0, i) = -polynomial[static_cast<std::size_t>(i) + 1].real();
  for (Eigen::Index i = 1; i < order; ++i) texture.A(i, i - 1) = 1;
  return texture;
}

double martin(const LinearDynamicTexture& p, const LinearDynamicTexture& q) {
  return dytex::martin_distance(dytex::subspace_angles(p, q));
}

/// Martin 2000: d² = log Π |1 − a b*|² / (Π |1 − a a*| Π |1 − b b*|) over all pairs of poles.
double closed_form(const std::vector<std::complex<double>>& a, const std::vector<std::complex<double>>& b) {
  const auto product = [](const auto& x, const auto& y) {
    double log = 0;
    for (const auto& u : x)
      for (const auto& v : y) log += std::log(std::abs(1.0 - u * std::conj(v)));
    return log;
  };
  return std::sqrt(2 * product(a, b) - product(a, a) - product(b, b));
}

}  // namespace

TEST_CASE("Martin's distance of first-order auto-regressions is the closed form", "[dytex][martin]") {
  for (const double a : {-0.9, -0.3, 0.0, 0.5, 0.99, 0.999, 0.99999})
    for (const double b : {-0.99, 0.1, 0.7, 0.9, 0.9999}) {
      CAPTURE(a, b);
      CHECK_THAT(martin(auto_regression({a}), auto_regression({b})), WithinRel(closed_form({a}, {b}), 1e-9));
    }
}

TEST_CASE("Martin's distance of higher auto-regressions is the closed form", "[dytex][martin]") {
  const auto pair = [](double radius, double angle) {
    return std::vector<std::complex<double>>{std::polar(radius, angle), std::polar(radius, -angle)};
  };
  std::vector<std::complex<double>> four = pair(0.95, 0.4);
  four.push_back(0.3);
  four.push_back(-0.6);
  for (const auto& [a, b] : {std::pair{pair(0.9, 0.5), pair(0.9, 0.7)},
                             {pair(0.99, 1), pair(0.5, 2)},
                             {pair(0.999, 0.3), pair(0.999, 0.31)}})
    CHECK_THAT(martin(auto_regression(a), auto_regression(b)), WithinRel(closed_form(a, b), 1e-7));
  std::vector<std::complex<double>> others{0.9, 0.2, -0.1, -0.7};
  CHECK_THAT(martin(auto_regression(four), auto_regression(others)),
             WithinRel(closed_form(four, others), 1e-7));
}

TEST_CASE("Martin's distance is symmetric and 0 of equals in any coordinates", "[dytex][martin]") {
  for (const double radius : {0.5, 0.9, 0.999}) {
    const LinearDynamicTexture p = made_texture(5, 4, 4, 1, radius), q = made_texture(5, 4, 3, 2, radius);
    CAPTURE(radius);
    CHECK(martin(p, p) == 0);
    CHECK(martin(p, test::in_other_coordinates(p)) == 0);
    CHECK(martin(p, q) > 1);
    CHECK_THAT(martin(q, p), WithinRel(martin(p, q), 1e-9));
    CHECK_THAT(martin(test::in_other_coordinates(p), q), WithinRel(martin(p, q), 1e-9));
    // Mean and noise do not count.
    LinearDynamicTexture moved = p;
    moved.mean.array() += 20;
    moved.B *= 3;
    moved.r = 0;
    CHECK(martin(p, moved) == 0);
  }
}

TEST_CASE("Martin's distance is infinite across a right angle", "[dytex][martin]") {
  LinearDynamicTexture p = made_texture(2, 1, 1, 1), q = made_texture(2, 1, 1, 2);
  p.C << 1, 0;
  q.C << 0, 1;
  const Eigen::VectorXd angles = dytex::subspace_angles(p, q);
  CHECK_THAT(angles[0], WithinAbs(std::acos(0.0), 1e-12));
  Eigen::VectorXd right = Eigen::VectorXd::Constant(2, 0.5);
  CHECK_THAT(dytex::martin_distance(right), WithinRel(std::sqrt(-4 * std::log(std::cos(0.5))), 1e-12));
  CHECK(dytex::martin_distance(angles) > 8);
}
