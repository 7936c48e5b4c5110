// SPDX-License-Identifier: Apache-2.0
// Forecasts against the model's own statistics, and the learning curve against learning itself.
#include "dytex/estimation/forecast.hpp"

#include <cmath>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/learning_curve.hpp"
#include "dytex/synthesize.hpp"
#include "tests/dytex/estimation/em_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

dytex::LinearDynamicTexture known_texture(const test::KnownClip& known, int width, int height) {
  dytex::LinearDynamicTexture texture;
  const Eigen::Index m = known.C.rows(), frames = known.states.cols();
  texture.info = {width, height, 1, CV_32F, 25, 1, frames};
  texture.mean = Eigen::VectorXf::Constant(m, 128);
  texture.C = known.C.cast<float>();
  texture.weights = Eigen::VectorXd::Ones(4);
  texture.A = known.A;
  texture.B = (60 * Eigen::Vector4d(1, 0.9, 0.8, 0.7)).asDiagonal();
  texture.r = known.r;
  texture.states = known.states;
  texture.singular = Eigen::VectorXd::Zero(frames);
  return texture;
}

}  // namespace

TEST_CASE("A forecast misses by what it says it will", "[dytex][forecast]") {
  const auto known = test::known_clip(30 * 20, 900, 9, 3);
  const auto texture = known_texture(known, 30, 20);
  const core::Clip clip = test::clip_of(known.levels, 30, 20, 1, CV_32F);
  const Eigen::MatrixXd levels = test::levels_of(clip);
  core::ClipSource source(clip);
  const auto filtered = dytex::filter(dytex::state_space(texture), dytex::observe(texture, source));
  constexpr int kSteps = 12;
  Eigen::VectorXd missed = Eigen::VectorXd::Zero(kSteps), expected = missed;
  int count = 0;
  for (Eigen::Index t = 20; t + kSteps < 900; t += 5, ++count) {
    const dytex::StateGuess from{
        filtered.states.col(t),
        filtered.steps[static_cast<std::size_t>(filtered.step[static_cast<std::size_t>(t)])].filtered};
    const auto forecast = dytex::forecast(texture, from, kSteps);
    for (int k = 0; k < kSteps; ++k) {
      const Eigen::VectorXd shown = known.C * forecast.states.col(k) + Eigen::VectorXd::Constant(600, 128);
      missed[k] += (levels.col(t + 1 + k) - shown).squaredNorm() / 600;
      expected[k] += forecast.error[k] * forecast.error[k];
    }
  }
  for (int k = 0; k < kSteps; ++k) {
    INFO("step " << k + 1);
    CHECK_THAT(std::sqrt(missed[k] / count), WithinRel(std::sqrt(expected[k] / count), 0.06));
  }
  CHECK(expected[11] > 1.3 * expected[0]);
}

TEST_CASE("Far ahead a forecast is the mean with the stationary covariance", "[dytex][forecast]") {
  const auto texture = known_texture(test::known_clip(48, 20, 2, 4), 8, 6);
  const auto from = dytex::last_training_state(texture);
  CHECK(from.mean == texture.states.col(19));
  CHECK((from.factor * from.factor.transpose()).diagonal().maxCoeff() <
        2.001);  // no worse than one frame tells
  const auto forecast = dytex::forecast(texture, from, 600);
  const Eigen::MatrixXd P = dytex::stationary_covariance(texture.A, texture.B);
  CHECK(forecast.states.col(599).norm() < 1e-4 * texture.states.col(19).norm());
  CHECK((forecast.covariances[599] - P).norm() < 1e-6 * P.norm());
  CHECK_THAT(forecast.error[599], WithinRel(std::sqrt(P.trace() / 48 + 2), 1e-6));
  CHECK((forecast.states.col(0) - texture.A * texture.states.col(19)).norm() == 0);
  for (int k = 1; k < 600; ++k) REQUIRE(forecast.error[k] >= forecast.error[k - 1] - 1e-9);
}

TEST_CASE("The deviation of each value is that of its covariance", "[dytex][forecast]") {
  auto texture = known_texture(test::known_clip(48, 20, 2, 4), 8, 6);
  texture.weights[1] = 0.5;
  const Eigen::MatrixXd root = 5 * test::normals(4, 4, 8), P = root * root.transpose();
  for (const bool per_value : {false, true}) {
    if (per_value) texture.noise = test::normals(48, 1, 9).array().square().matrix().cast<float>();
    const cv::Mat deviation = dytex::forecast_deviation(texture, P);
    const Eigen::MatrixXd C = texture.C.cast<double>() * texture.weights.asDiagonal();
    for (int p = 0; p < 48; ++p) {
      const double noise = per_value ? static_cast<double>(texture.noise[p]) : 2;
      CHECK_THAT(static_cast<double>(deviation.at<float>(p / 8, p % 8)),
                 WithinRel(std::sqrt((C.row(p) * P * C.row(p).transpose()).value() + noise), 1e-5));
    }
    const dytex::StateGuess from{Eigen::VectorXd::Zero(4), root};
    const double expected = dytex::forecast(texture, from, 1).error[0];
    const cv::Mat next = dytex::forecast_deviation(texture, dytex::forecast(texture, from, 1).covariances[0]);
    CHECK_THAT(cv::norm(next) / std::sqrt(48.0), WithinRel(expected, 1e-4));
  }
}

TEST_CASE("What a forecast cannot take is named", "[dytex][forecast]") {
  const auto texture = known_texture(test::known_clip(48, 20, 2, 4), 8, 6);
  const dytex::StateGuess from{Eigen::VectorXd::Zero(4), Eigen::MatrixXd::Zero(4, 0)};
  const auto said = [](const auto& call) { return test::message_of<core::InputError>(call); };
  CHECK(said([&] { dytex::forecast(texture, from, 0); }) == "forecast: steps is 0; allowed is 1 to 100000");
  CHECK_THAT(said([&] {
               dytex::forecast(texture, {Eigen::VectorXd::Zero(3), Eigen::MatrixXd::Zero(3, 1)}, 2);
             }),
             Contains("3 numbers") && Contains("4"));
  CHECK_THAT(said([&] { dytex::forecast_deviation(texture, Eigen::MatrixXd::Zero(3, 3)); }),
             Contains("3 × 3"));
}

TEST_CASE("The learning curve's errors are those of models that are learned", "[dytex][forecast]") {
  const core::Clip clip = test::wavy_clip(16, 12, 3, CV_8U, 48);
  core::ClipSource source(clip);
  const dytex::CurveOptions options{.components = 5, .lengths = 6, .targets = 3};
  const auto curve = dytex::learning_curve(source, options);
  REQUIRE(curve.targets == std::vector<int>{39, 43, 47});
  REQUIRE(curve.points.front().length == 7);
  REQUIRE(curve.points.back().length == 39);
  const Eigen::MatrixXd levels = test::levels_of(clip);
  for (const auto& point : curve.points) {
    double sum = 0, squares = 0;
    for (const int target : curve.targets) {
      core::Clip window{clip.info, {}};
      window.info.frames = point.length;
      for (int t = target - point.length; t < target; ++t)
        window.frames.push_back(clip.frames[static_cast<std::size_t>(t)]);
      core::ClipSource of(window);
      const auto learned = dytex::learn(of, {.components = 5, .energy = {}}).texture;
      const cv::Mat shown = dytex::predict(learned, core::to_levels(window.frames.back(), clip.info));
      const Eigen::VectorXd guess =
          Eigen::Map<const Eigen::VectorXf>(shown.ptr<float>(), levels.rows()).cast<double>();
      const double error =
          (levels.col(target) - guess).norm() / std::sqrt(static_cast<double>(levels.rows()));
      sum += error / 3, squares += error * error / 3;
    }
    INFO("length " << point.length);
    CHECK_THAT(point.error, WithinRel(sum, 1e-5));
    CHECK_THAT(point.spread, WithinAbs(std::sqrt(std::max(squares - sum * sum, 0.0)), 1e-4));
    CHECK(point.left_out <= point.error);
  }
  double before = 0;
  for (const int target : curve.targets)
    before += (levels.col(target) - levels.col(target - 1)).norm() /
              std::sqrt(static_cast<double>(levels.rows())) / 3;
  CHECK_THAT(curve.frame_before, WithinRel(before, 1e-9));
  for (const std::size_t threads : {1, 8}) {
    const core::ThreadLimit limit(threads);
    const auto again = dytex::learning_curve(source, options);
    for (std::size_t i = 0; i < curve.points.size(); ++i)
      CHECK(again.points[i].error == curve.points[i].error);
  }
}

TEST_CASE("The learning curve falls and comes to rest where the clip is long enough", "[dytex][forecast]") {
  const auto known = test::known_clip(400, 200, 1, 6);
  const core::Clip clip = test::clip_of(known.levels, 20, 20, 1, CV_32F);
  core::ClipSource long_source(clip);
  const dytex::CurveOptions options{.components = 4, .lengths = 16, .targets = 16};
  const auto curve = dytex::learning_curve(long_source, options);
  CHECK(curve.points.front().error > 1.1 * curve.plateau);
  REQUIRE(curve.critical.has_value());
  CHECK(*curve.critical < 130);
  CHECK(curve.plateau < curve.frame_before);
}

TEST_CASE("What the learning curve cannot take is named", "[dytex][forecast]") {
  const core::Clip clip = test::wavy_clip(12, 10, 1, CV_8U, 20);
  core::ClipSource source(clip);
  const auto said = [&](dytex::CurveOptions options) {
    return test::message_of<core::InputError>([&] { dytex::learning_curve(source, options); });
  };
  dytex::CurveOptions options;
  CHECK_THAT(said(options), Contains("components is 20") && Contains("allowed is 1 to 12"));
  options.components = 12;
  CHECK(said(options).empty());
  options.components = 13;
  CHECK_FALSE(said(options).empty());
  options = {};
  options.lengths = 1;
  CHECK(said(options) == "CurveOptions.lengths is 1; allowed is 2 to 1000");
  options = {};
  options.tolerance = 0;
  CHECK(said(options) == "CurveOptions.tolerance is 0; allowed is above 0");
}
