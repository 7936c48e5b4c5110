// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/linear_textures.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using dytex::LinearDynamicTexture;

Eigen::MatrixXd root(const Eigen::MatrixXd& matrix) {
  const test::SymmetricEigen eigen = test::symmetric_eigen(matrix);
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
}

/// The noise in the states where a white image u drives the model's frames by the square root of their
/// noise's covariance: v = Cᵀ (C Q Cᵀ)^½ u.
Eigen::MatrixXd driven_by_image(const LinearDynamicTexture& texture) {
  const Eigen::MatrixXd C = texture.C.cast<double>();
  return C.transpose() * root(C * texture.B * texture.B.transpose() * C.transpose());
}

/// Frame by frame, E x_p x_qᵀ carried along.
double by_frames(const LinearDynamicTexture& p, const LinearDynamicTexture& q, double discount, bool start) {
  const Eigen::MatrixXd noise = driven_by_image(p) * driven_by_image(q).transpose();
  Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(p.order(), q.order());
  if (start) moment = p.states.col(0) * q.states.col(0).transpose();
  double sum = 0;
  for (int t = 0; t < 4000; ++t) {
    sum += std::exp(-discount * t) * (test::whole_C(p) * moment * test::whole_C(q).transpose()).trace();
    moment = (p.A * moment * q.A.transpose() + noise).eval();
  }
  return sum;
}

}  // namespace

TEST_CASE("The trace kernel is the sum over frames driven by one image", "[dytex][kernel]") {
  LinearDynamicTexture p = made_texture(3, 3, 3, 1, 0.95);
  const LinearDynamicTexture q = made_texture(3, 3, 2, 2, 0.8);
  for (const double discount : {0.05, 0.9, 3.0})
    for (const bool start : {false, true}) {
      CAPTURE(discount, start);
      const dytex::BinetCauchyOptions options{discount, start};
      const double size = by_frames(p, p, discount, start);
      CHECK_THAT(dytex::binet_cauchy(p, p, options), WithinRel(size, 1e-6));
      CHECK_THAT(dytex::binet_cauchy(p, q, options),
                 WithinAbs(by_frames(p, q, discount, start), 1e-6 * size));
    }
  p.weights << 0.5, 2, 0;
  CHECK_THAT(dytex::binet_cauchy(p, q), WithinAbs(by_frames(p, q, 0.9, false), 1e-5));
}

TEST_CASE("The trace kernel is symmetric and knows no coordinates", "[dytex][kernel]") {
  const LinearDynamicTexture p = made_texture(4, 3, 3, 3), q = made_texture(4, 3, 4, 4);
  for (const bool start : {false, true}) {
    const dytex::BinetCauchyOptions options{0.5, start};
    const double kernel = dytex::binet_cauchy(p, q, options);
    CHECK_THAT(dytex::binet_cauchy(q, p, options), WithinRel(kernel, 1e-10));
    CHECK_THAT(dytex::binet_cauchy(test::in_other_coordinates(p), q, options), WithinRel(kernel, 1e-10));
    CHECK_THAT(dytex::binet_cauchy(p, test::in_other_coordinates(q), options), WithinRel(kernel, 1e-10));
    CHECK_THAT(dytex::distances(p, p, options).binet_cauchy, WithinRel(1.0, 1e-12));
    CHECK_THAT(
        dytex::distances(p, q, options).binet_cauchy,
        WithinRel(kernel / std::sqrt(dytex::binet_cauchy(p, p, options) * dytex::binet_cauchy(q, q, options)),
                  1e-10));
  }
}

TEST_CASE("A matrix of trace kernels has no negative eigenvalue", "[dytex][kernel]") {
  constexpr Eigen::Index kModels = 12;  // more than a frame has values: some eigenvalue is near 0
  for (const bool start : {false, true}) {
    Eigen::MatrixXd gram(kModels, kModels);
    const auto model = [](Eigen::Index i) {
      return made_texture(2, 2, 1 + i % 3, static_cast<std::uint64_t>(i + 1),
                          0.3 + 0.05 * static_cast<double>(i));
    };
    for (Eigen::Index i = 0; i < kModels; ++i)
      for (Eigen::Index j = 0; j < kModels; ++j)
        gram(i, j) = dytex::binet_cauchy(model(i), model(j), {0.4, start});
    const Eigen::VectorXd values = test::symmetric_eigenvalues(gram);
    CHECK(values[0] > -1e-6 * values[kModels - 1]);
    CHECK(values[kModels - 1] > 0);
  }
}

TEST_CASE("The discount of the trace kernel is checked", "[dytex][kernel]") {
  const LinearDynamicTexture p = made_texture(3, 2, 2, 1);
  for (const double bad : {0.0, -1.0, 51.0, std::numeric_limits<double>::quiet_NaN()})
    CHECK(test::message_of<core::InputError>([&] {
            dytex::binet_cauchy(p, p, {bad, false});
          }).ends_with("allowed is 0.001 to 50"));
  CHECK(test::message_of<core::InputError>([&] {
          dytex::distances(p, p, {0, false});
        }) == "BinetCauchyOptions.discount is 0; allowed is 0.001 to 50");
}
