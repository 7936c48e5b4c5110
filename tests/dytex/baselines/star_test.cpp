// SPDX-License-Identifier: Apache-2.0
#include "dytex/baselines/star.hpp"

#include <cmath>
#include <limits>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "dytex/baselines/star_waves.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using namespace emberfold::test;

namespace {

Star made(int width, int height, int channels) {
  Star star;
  star.info.width = width, star.info.height = height, star.info.channels = channels;
  star.info.depth = CV_8U;
  star.mean = Eigen::VectorXf::Constant(Eigen::Index{width} * height * channels, 128);
  star.terms = star_terms({1, 2});
  star.coefficients = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(star.terms.size()));
  star.noise = 4 * Eigen::MatrixXd::Identity(channels, channels);
  return star;
}

double& coefficient(Star& star, const StarTerm& term) {
  for (std::size_t i = 0; i < star.terms.size(); ++i)
    if (star.terms[i] == term) return star.coefficients(static_cast<Eigen::Index>(i));
  FAIL("no such term");
  return star.coefficients(0);
}

// Travels to the right, its waves curved by the same frame's neighbours.
Star travelling(int channels = 1) {
  auto star = made(48, 40, channels);
  coefficient(star, {-1, 0, 1}) = 0.4;
  coefficient(star, {0, 0, 1}) = 0.35;
  coefficient(star, {0, 0, 2}) = -0.2;
  coefficient(star, {0, -1, 0}) = 0.25;
  coefficient(star, {-1, 0, 0}) = 0.2;
  coefficient(star, {-1, -1, 1}) = -0.15;
  return star;
}

core::Clip drawn(const Star& star, int frames, std::uint64_t seed) {
  StarSynthesis synthesis(star, seed);
  core::Clip clip{star.info, {}};
  for (int t = 0; t < frames; ++t) clip.frames.push_back(synthesis.next());
  return clip;
}

}  // namespace

TEST_CASE("STAR is learned back from what it draws") {
  for (const int channels : {1, 3}) {
    auto truth = travelling(channels);
    if (channels == 3) truth.noise << 4, 0, 0, 2, 3, 0, 1, 1, 2;
    const auto clip = drawn(truth, 160, 7);
    core::ClipSource source(clip);
    const auto learned = learn_star(source, {1, 2});
    CHECK(learned.notes.empty());
    CHECK(learned.star.terms == truth.terms);
    // 65536 pixels tell a coefficient to some 1/√65536; rounding to whole levels adds noise of 1/12
    for (Eigen::Index i = 0; i < truth.coefficients.size(); ++i)
      CHECK_THAT(learned.star.coefficients(i), WithinAbs(truth.coefficients(i), 0.025));
    const Eigen::MatrixXd noise = learned.star.noise * learned.star.noise.transpose(),
                          expected = truth.noise * truth.noise.transpose();
    for (int a = 0; a < channels; ++a)
      for (int b = 0; b < channels; ++b) CHECK_THAT(noise(a, b), WithinAbs(expected(a, b), 0.6));
    CHECK_THAT(learned.least_squares_radius, WithinAbs(spectral_radius(truth), 0.03));
  }
}

TEST_CASE("STAR predicts by its own equation") {
  const auto star = travelling();
  core::Rng rng(3);
  std::vector<cv::Mat> past;
  for (int t = 0; t < 3; ++t) {
    cv::Mat frame(40, 48, CV_32F);
    for (auto& value : cv::Mat_<float>(frame)) value = static_cast<float>(rng.uniform(0, 255));
    past.push_back(frame);
  }
  const auto told = predict(star, past, 2);
  REQUIRE(told.size() == 2);
  // Written out, value by value; nothing is expected of disturbances.
  std::vector<cv::Mat> s;
  for (const auto& frame : past) s.push_back(frame - 128);
  for (int k = 0; k < 2; ++k) {
    cv::Mat next(40, 48, CV_32F, cv::Scalar(0));
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 48; ++x) {
        double sum = 0;
        for (std::size_t i = 0; i < star.terms.size(); ++i) {
          const auto& term = star.terms[i];
          const int u = x + term.x, v = y + term.y;
          if (term.lag == 0 || u < 0 || v < 0 || u >= 48 || v >= 40) continue;
          const auto& from = s[s.size() - static_cast<std::size_t>(term.lag)];
          sum += star.coefficients(static_cast<Eigen::Index>(i)) * static_cast<double>(from.at<float>(v, u));
        }
        next.at<float>(y, x) = static_cast<float>(sum);
      }
    s.push_back(next);
    CHECK(cv::norm(told[static_cast<std::size_t>(k)] - 128, next, cv::NORM_INF) < 1e-2);
  }
}

TEST_CASE("the radius of STAR is that of what it does") {
  auto star = made(32, 32, 1);
  coefficient(star, {0, 0, 1}) = 0.9;
  CHECK_THAT(spectral_radius(star), WithinAbs(0.9, 1e-12));
  coefficient(star, {0, 0, 2}) = -0.81;  // λ = 0.9 e^{±iπ/3}
  CHECK_THAT(spectral_radius(star), WithinAbs(0.9, 1e-12));
  coefficient(star, {0, 0, 2}) = 0;
  coefficient(star, {-1, 0, 0}) = 0.5;  // how disturbances look is no matter of growth
  CHECK_THAT(spectral_radius(star), WithinAbs(0.9, 1e-12));
  coefficient(star, {1, 0, 1}) = 0.9;
  CHECK_THAT(spectral_radius(star), WithinAbs(1.8, 1e-12));
  CHECK_THROWS_AS(StarSynthesis(star, 1), core::InputError);
}

TEST_CASE("the radius of STAR is that of its fastest wave and of its slower root") {
  auto star = made(32, 32, 1);
  coefficient(star, {0, 0, 1}) = -0.7;  // λ² + 0.7 λ − 0.18 = (λ + 0.9)(λ − 0.2)
  coefficient(star, {0, 0, 2}) = 0.18;
  CHECK_THAT(spectral_radius(star), WithinAbs(0.9, 1e-12));
  coefficient(star, {0, 0, 2}) = 0;
  // 0.3 − 0.6 cos k grows most where neighbouring rows, or columns, are opposite.
  for (const bool rows : {false, true}) {
    auto waves = made(32, 32, 1);
    coefficient(waves, {0, 0, 1}) = 0.3;
    coefficient(waves, rows ? StarTerm{0, -1, 1} : StarTerm{-1, 0, 1}) = -0.3;
    coefficient(waves, rows ? StarTerm{0, 1, 1} : StarTerm{1, 0, 1}) = -0.3;
    CHECK_THAT(spectral_radius(waves), WithinAbs(0.9, 1e-12));
  }
}

TEST_CASE("a clip that grows is learned as a model that does not") {
  auto star = made(24, 20, 1);
  core::Clip clip{star.info, {}};
  clip.info.depth = CV_32F;
  core::Rng rng(5);
  cv::Mat frame(20, 24, CV_32F);
  for (auto& value : cv::Mat_<float>(frame)) value = static_cast<float>(rng.normal());
  for (int t = 0; t < 40; ++t) {
    cv::Mat next = 1.08 * frame;
    for (auto& value : cv::Mat_<float>(next)) value += static_cast<float>(0.05 * rng.normal());
    clip.frames.push_back(frame = next);
  }
  core::ClipSource source(clip);
  const auto learned = learn_star(source, {1, 1});
  CHECK(learned.least_squares_radius > 1);
  REQUIRE(learned.notes.size() >= 1);
  CHECK(learned.notes.back().find("not stable") != std::string::npos);
  CHECK_THAT(spectral_radius(learned.star), WithinAbs(0.998, 1e-6));
  StarSynthesis synthesis(learned.star, 1);
  for (int t = 0; t < 20; ++t) CHECK(synthesis.next().size() == cv::Size(24, 20));
}

TEST_CASE("what is scaled to be stable has the radius it is scaled to, and varies as the clip does") {
  core::Clip clip{made(24, 20, 1).info, {}};
  clip.info.depth = CV_32F;
  core::Rng rng(6);
  cv::Mat1f frame(20, 24);
  for (auto& value : frame) value = static_cast<float>(rng.normal());
  Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(20, 24), squares = sum;
  for (int t = 0; t < 30; ++t) {
    cv::Mat1f next(20, 24);
    cv::scaleAdd(frame, 1.08, cv::Mat1f::zeros(20, 24), next);
    for (auto& value : next) value += static_cast<float>(0.05 * rng.normal());
    clip.frames.push_back(frame = next);
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) {
        const double level = double{frame(y, x)};
        sum(y, x) += level, squares(y, x) += level * level;
      }
  }
  const double variance = (squares / 30 - (sum / 30).square()).mean();
  for (const int lags : {1, 2}) {
    core::ClipSource source(clip);
    const auto learned = learn_star(source, {1, lags});
    REQUIRE(learned.least_squares_radius > 1);
    CHECK_THAT(spectral_radius(learned.star), WithinAbs(0.998, 1e-6));
    if (lags > 1) continue;
    // A wave z(t) = f z(t − 1) + g a(t) has the variance |g|² / (1 − |f|²) of a's.
    double gain = 0;
    int waves = 0;
    detail::for_each_wave(learned.star, [&](const detail::Wave& wave) {
      gain += std::norm(wave.gain) / (1 - std::norm(wave.first));
      ++waves;
    });
    CHECK_THAT(gain / waves * learned.star.noise.squaredNorm(), WithinRel(variance, 1e-3));
  }
}

TEST_CASE("what never changes is drawn as it is") {
  core::Clip clip{made(12, 10, 3).info, {}};
  for (int t = 0; t < 8; ++t) clip.frames.emplace_back(10, 12, CV_8UC3, cv::Scalar(10, 20, 30));
  core::ClipSource source(clip);
  const auto learned = learn_star(source);
  CHECK(learned.star.coefficients.norm() == 0);
  StarSynthesis synthesis(learned.star, 1);
  CHECK(cv::norm(synthesis.next(), clip.frames[0], cv::NORM_INF) == 0);
}

TEST_CASE("STAR refuses what it cannot take") {
  CHECK_THROWS_AS(star_terms({0, 1}), core::InputError);
  CHECK_THROWS_AS(star_terms({1, 3}), core::InputError);
  CHECK(star_terms({1, 2}).size() == 4 + 18);
  CHECK(star_terms({2, 1}).size() == 12 + 25);
  core::Clip clip{made(12, 10, 1).info, {}};
  for (int t = 0; t < 3; ++t) clip.frames.emplace_back(10, 12, CV_8UC1, cv::Scalar(10));
  core::ClipSource source(clip);
  CHECK_THROWS_AS(learn_star(source, {1, 2}), core::InputError);  // 3 frames, 4 needed
  core::Clip small{made(9, 9, 1).info, std::vector<cv::Mat>(9, cv::Mat(9, 9, CV_8U, cv::Scalar(3)))};
  core::ClipSource narrow(small);
  CHECK_THROWS_AS(learn_star(narrow, {2, 1}), core::InputError);  // a side of 10 is needed
  auto star = made(12, 10, 1);
  CHECK_THROWS_AS(predict(star, std::vector<cv::Mat>{}, 1), core::InputError);
  CHECK_THROWS_AS(predict(star, std::vector<cv::Mat>(2, cv::Mat(10, 12, CV_8U)), 1), core::InputError);
  star.terms[0] = {1, 0, 0};
  CHECK_THROWS_AS(validate(star), core::InputError);
  star = made(12, 10, 1);
  star.coefficients(0) = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(validate(star), core::InputError);
}
