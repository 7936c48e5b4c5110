// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/learn.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/linear_textures.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using dytex::LinearDynamicTexture;

struct Gaussian {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// All values of `frames` frames as one dense Gaussian.
Gaussian dense(const LinearDynamicTexture& texture, Eigen::Index frames) {
  const Eigen::Index m = texture.pixels();
  const Eigen::MatrixXd C = test::whole_C(texture), P = dytex::stationary_covariance(texture.A, texture.B);
  Eigen::VectorXd R = Eigen::VectorXd::Constant(m, texture.r);
  if (texture.noise.size() > 0) R = texture.noise.cast<double>();
  Gaussian result{texture.mean.cast<double>().replicate(frames, 1), Eigen::MatrixXd(m * frames, m * frames)};
  Eigen::MatrixXd lagged = P;
  for (Eigen::Index lag = 0; lag < frames; ++lag) {
    Eigen::MatrixXd block = C * lagged * C.transpose();
    if (lag == 0) block.diagonal() += R;
    for (Eigen::Index t = 0; t + lag < frames; ++t) {
      result.covariance.block((t + lag) * m, t * m, m, m) = block;
      result.covariance.block(t * m, (t + lag) * m, m, m) = block.transpose();
    }
    lagged = (texture.A * lagged).eval();
  }
  return result;
}

double dense_kl(const LinearDynamicTexture& p, const LinearDynamicTexture& q, Eigen::Index frames) {
  const Gaussian a = dense(p, frames), b = dense(q, frames);
  const Eigen::VectorXd away = a.mean - b.mean;
  const Eigen::VectorXd weighted = test::solve_positive(b.covariance, away);
  return 0.5 * (test::solve_positive(b.covariance, a.covariance).trace() + away.dot(weighted) -
                static_cast<double>(away.size()) + test::log_determinant(b.covariance) -
                test::log_determinant(a.covariance));
}

struct Case {
  const char* name;
  LinearDynamicTexture p, q;
};

/// Pairs of every kind that a texture can be of.
std::vector<Case> cases() {
  std::vector<Case> all{
      {"plain", made_texture(3, 2, 2, 1), made_texture(3, 2, 2, 2)},
      {"other orders", made_texture(3, 2, 3, 3, 0.9), made_texture(3, 2, 1, 4, 0.5)},
      {"more states than components", made_texture(3, 2, 1, 5, 0.7, 3), made_texture(3, 2, 2, 6)},
      {"no components in the first", made_texture(3, 2, 0, 7), made_texture(3, 2, 2, 8)},
      {"no components in the second", made_texture(3, 2, 2, 9), made_texture(3, 2, 0, 10)},
      {"no components", made_texture(3, 2, 0, 11), made_texture(3, 2, 0, 12)}};
  Case edited{"edited weights", made_texture(3, 2, 3, 13), made_texture(3, 2, 3, 14)};
  edited.p.weights << 0.5, 0, 2;
  edited.q.weights << 1, 3, -0.25;
  all.push_back(edited);
  Case noises{"a noise for every value", made_texture(3, 2, 2, 15), made_texture(3, 2, 2, 16)};
  noises.p.noise = Eigen::VectorXf::LinSpaced(6, 0.5F, 3);
  noises.q.r = 4;
  all.push_back(noises);
  noises.q.noise = Eigen::VectorXf::LinSpaced(6, 5, 1);
  noises.name = "other noises for every value";
  all.push_back(noises);
  Case one_input{"one noise input", made_texture(3, 2, 3, 17), made_texture(3, 2, 3, 18)};
  one_input.p.B = one_input.p.B.leftCols(1).eval();
  one_input.q.B = one_input.q.B.leftCols(1).eval();
  one_input.q.r = 0.2;
  all.push_back(one_input);
  return all;
}

}  // namespace

TEST_CASE("The growth of the divergence is that of dense Gaussians", "[dytex][kl]") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Eigen::VectorXd growth = dytex::kl_growth(c.p, c.q, 12);
    REQUIRE(growth.size() == 12);
    for (const Eigen::Index frames : {1, 2, 3, 7, 12})
      CHECK_THAT(growth[frames - 1], WithinRel(dense_kl(c.p, c.q, frames), 1e-9));
  }
}

TEST_CASE("The divergence rate is the slope of dense Gaussians", "[dytex][kl]") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const double slope = dense_kl(c.p, c.q, 81) - dense_kl(c.p, c.q, 80);
    CHECK_THAT(dytex::kl_rate(c.p, c.q), WithinRel(slope, 1e-8));
    const Eigen::VectorXd growth = dytex::kl_growth(c.p, c.q, 301);
    CHECK_THAT(growth[300] - growth[299], WithinRel(dytex::kl_rate(c.p, c.q), 1e-9));
  }
}

TEST_CASE("The divergence is 0 of equals and else above 0", "[dytex][kl]") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    CHECK(dytex::kl_rate(c.p, c.p) == 0);
    CHECK(dytex::kl_growth(c.p, c.p, 20).cwiseAbs().maxCoeff() == 0);
    CHECK(dytex::kl_rate(c.p, c.q) > 0.01);
    CHECK(dytex::kl_rate(c.q, c.p) > 0.01);
    const Eigen::VectorXd growth = dytex::kl_growth(c.p, c.q, 20);
    CHECK((growth.tail(19) - growth.head(19)).minCoeff() > 0);
    // A little away it is of the second order, no matter which way.
    LinearDynamicTexture near = c.p;
    near.mean.array() += 0.01F;
    const double forth = dytex::kl_rate(c.p, near), back = dytex::kl_rate(near, c.p);
    CHECK_THAT(forth, WithinRel(back, 1e-6));
    CHECK(forth > 0);
    CHECK(forth < 1e-3);
  }
}

TEST_CASE("The divergence does not depend on the states' coordinates", "[dytex][kl]") {
  const LinearDynamicTexture p = made_texture(4, 3, 3, 21), q = made_texture(4, 3, 4, 22);
  const double rate = dytex::kl_rate(p, q);
  CHECK_THAT(dytex::kl_rate(test::in_other_coordinates(p), q), WithinRel(rate, 1e-12));
  CHECK_THAT(dytex::kl_rate(p, test::in_other_coordinates(q)), WithinRel(rate, 1e-12));
  CHECK(dytex::kl_rate(p, test::in_other_coordinates(p)) == 0);
}

TEST_CASE("The divergence of still models is that of their noises", "[dytex][kl]") {
  LinearDynamicTexture p = made_texture(3, 2, 0, 1), q = p;
  q.r = 3;
  q.mean.array() += 2;
  const double by_hand = 6 * 0.5 * (1.5 / 3 + 4.0 / 3 - 1 + std::log(3 / 1.5));
  CHECK_THAT(dytex::kl_rate(p, q), WithinRel(by_hand, 1e-12));
  CHECK_THAT(dytex::kl_growth(p, q, 9)[8], WithinRel(9 * by_hand, 1e-12));
}

TEST_CASE("Models learned from halves of a clip are nearer than those of another clip", "[dytex][kl]") {
  const auto learned = [](std::uint64_t seed, std::size_t first, std::size_t last) {
    core::Clip clip = test::wavy_clip(30, 20, 1, CV_8U, 100, seed);
    clip.frames = {clip.frames.begin() + static_cast<std::ptrdiff_t>(first),
                   clip.frames.begin() + static_cast<std::ptrdiff_t>(last)};
    clip.info.frames = static_cast<std::int64_t>(clip.frames.size());
    core::ClipSource source(clip);
    return dytex::learn(source, {.components = 8, .energy = {}}).texture;
  };
  const auto a = learned(1, 0, 50), b = learned(1, 50, 100), other = learned(2, 0, 50);
  CHECK(dytex::kl_rate(a, a) == 0);
  CHECK(dytex::kl_rate(b, a) > 0);
  CHECK(20 * dytex::kl_rate(b, a) < dytex::kl_rate(other, a));
  CHECK(20 * dytex::kl_rate(a, b) < dytex::kl_rate(a, other));
}

TEST_CASE("Growth stops when it is told to", "[dytex][kl]") {
  const LinearDynamicTexture p = made_texture(3, 2, 2, 1), q = made_texture(3, 2, 2, 2);
  std::stop_source stop;
  const core::Context context(stop.get_token(), [&](std::string_view stage, double share) {
    CHECK(stage == "growth");
    if (share >= 0.5) stop.request_stop();
  });
  CHECK_THROWS_AS(dytex::kl_growth(p, q, 10, context), core::Cancelled);
}

TEST_CASE("What has no divergence is refused", "[dytex][kl]") {
  const LinearDynamicTexture p = made_texture(3, 2, 2, 1);
  LinearDynamicTexture q = made_texture(3, 2, 2, 2);
  const auto refusal = [&] { return test::message_of<core::InputError>([&] { dytex::kl_rate(p, q); }); };
  q.r = 0;
  CHECK(
      refusal() ==
      "the noise r of the second model is 0, so the KL rate is infinite; learn it with fewer components than "
      "the clip has independent frames, so that r is estimated");
  CHECK(test::message_of<core::InputError>([&] {
          dytex::kl_growth(q, p, 3);
        }).starts_with("the noise r of the first"));
  q.noise = Eigen::VectorXf::Ones(6);
  CHECK(refusal().empty());
  q.noise[3] = 0;
  CHECK(refusal().starts_with("the noise r of the second model is 0"));
  q = made_texture(2, 3, 2, 2);
  CHECK(refusal() ==
        "frames of 3×2 in grey and of 2×3 in grey cannot be compared; both must have the same size "
        "and channels");
  q = made_texture(3, 2, 2, 2);
  q.info.channels = 3;
  CHECK(refusal().starts_with("frames of 3×2 in grey and of 3×2 in colour"));
  for (const int length : {0, -1, 100'001})
    CHECK(test::message_of<core::InputError>([&] { dytex::kl_growth(p, p, length); }) ==
          "length is " + std::to_string(length) + "; allowed is 1 to 100000");
}
