// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/predict.hpp"

#include <cmath>

#include <Eigen/LU>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using graph::Point;

namespace {

test::Scene swaying(int frames) {
  test::Scene scene;
  scene.frames = frames;
  scene.strokes = test::scattered(5, 3, scene.width, scene.height, 60);
  scene.displacement = {1.7, -0.8, 0.25, 60};
  return scene;
}

mcmc::MotionModel model_of(const test::Scene& scene) {
  auto model = test::empty_model();
  model.displacement = {scene.displacement.a1,    scene.displacement.a2,    0,
                        scene.displacement.noise, scene.displacement.range, 0};
  return model;
}

// Root mean square error, px, across the curves, of frame t's predicted patches from where the curve truly is
// in frame t, and of the same had it stood still.
struct Errors {
  double predicted = 0, still = 0;
};
Errors errors(const test::Scene& scene, const test::Made& truth,
              const std::vector<graph::AttributeGraph>& predicted, int from) {
  Errors sums;
  double count = 0;
  for (int t = from; t < scene.frames; ++t) {
    const auto& graph = predicted[static_cast<std::size_t>(t)];
    const auto& where = truth.where[static_cast<std::size_t>(t) - 1];
    REQUIRE(graph.size() == where.size());
    for (std::size_t v = 0; v < graph.size(); ++v) {
      const auto& [i, s] = where[v];
      const auto& stroke = scene.strokes[i];
      if (s < 10 || s > stroke.length - 10) continue;
      const Point moved = scene.drift ? scene.drift(stroke.start) * double(t) : Point{};
      const Point at = stroke.at(s) + stroke.normal(s) * truth.displacement[i].at(s, t) + moved;
      const Point before = truth.motion.sketch.frames[static_cast<std::size_t>(t) - 1].patch(v).position;
      sums.predicted += std::pow(graph::dot(graph.patch(v).position - at, stroke.normal(s)), 2);
      sums.still += std::pow(graph::dot(before - at, stroke.normal(s)), 2);
      ++count;
    }
  }
  return {std::sqrt(sums.predicted / count), std::sqrt(sums.still / count)};
}

}  // namespace

TEST_CASE("A prediction is nearly as good as the noise lets it be", "[predict]") {
  auto scene = swaying(150);
  const auto truth = test::make(scene, 31);
  const auto predicted = mcmc::predict(model_of(scene), truth.motion);
  REQUIRE(predicted.size() == 150);
  CHECK(predicted[0].empty());
  const auto [error, still] = errors(scene, truth, predicted, 30);
  // With the exact law, rest and past the error is the noise; that of standing still is √(2 − 2 a1/(1 − a2))
  // deviations.
  CHECK(still > 1.5 * scene.displacement.noise);
  CHECK(error > 0.9 * scene.displacement.noise);
  CHECK(error < 1.25 * scene.displacement.noise);
  CHECK(error < 0.75 * still);
}

TEST_CASE("A drift is part of a prediction", "[predict]") {
  auto scene = swaying(60);
  scene.displacement.noise = 0.1;
  scene.drift = [](Point) { return Point{0.5, 0.4}; };
  const auto truth = test::make(scene, 32);
  auto model = model_of(scene);
  const auto without = errors(scene, truth, mcmc::predict(model, truth.motion), 20);
  for (double& value : model.drift_x.values) value = 0.5;
  for (double& value : model.drift_y.values) value = 0.4;
  const auto with = errors(scene, truth, mcmc::predict(model, truth.motion), 20);
  CHECK(with.predicted < 1.35 * scene.displacement.noise);
  CHECK(with.predicted < without.predicted);
}

TEST_CASE("A prediction is the best linear one of what was seen so far", "[predict]") {
  // A line that sways up and down, seen with an error, and drifts.
  const std::vector<double> y{0, 0.5, 0.9, 0.7, 1.2, 1.5, 1.1, 1.9};
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links(y.size() - 1);
  for (const double offset : y) {
    test::Frame frame;
    frame.line(test::segment({20, 100 + offset}, {80, 100 + offset}, 13));
    frames.push_back(frame.graph());
  }
  for (auto& gap : links)
    for (std::uint32_t v = 0; v < 13; ++v) gap.emplace_back(v, v);
  const auto motion = graph::identify(test::motion(frames, links));
  auto model = test::empty_model();
  constexpr double a1 = 1.2, a2 = -0.5, noise = 0.3, error = 0.5, drift = 0.2;
  model.displacement = {a1, a2, 0, noise, 20, error};
  for (double& value : model.drift_y.values) value = drift;
  std::vector<double> gamma{noise * noise * (1 - a2) / ((1 + a2) * ((1 - a2) * (1 - a2) - a1 * a1))};
  gamma.push_back(gamma[0] * a1 / (1 - a2));
  for (std::size_t k = 2; k < 12; ++k) gamma.push_back(a1 * gamma[k - 1] + a2 * gamma[k - 2]);
  for (const int steps : {1, 3}) {
    const auto predicted = mcmc::predict(model, motion, steps);
    for (Eigen::Index n = 3; n + steps <= static_cast<Eigen::Index>(y.size()); ++n) {
      // Of n frames: the rest by generalised least squares, and the deviation by its covariances with theirs.
      Eigen::MatrixXd seen(n, n);
      Eigen::VectorXd values(n), ahead(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) seen(i, j) = gamma[static_cast<std::size_t>(std::abs(i - j))];
        seen(i, i) += error * error + 0.02 * 0.02;  // and the least error of a measured place
        values[i] = y[static_cast<std::size_t>(i)] - drift * static_cast<double>(i);
        ahead[i] = gamma[static_cast<std::size_t>(n - 1 + steps - i)];
      }
      const Eigen::MatrixXd inverse = seen.inverse();
      const Eigen::VectorXd one = Eigen::VectorXd::Ones(n);
      const double rest = one.dot(inverse * values) / one.dot(inverse * one);
      const double expected = 100 + rest + ahead.dot(inverse * (values - rest * one)) +
                              drift * static_cast<double>(n - 1 + steps);
      INFO(steps << " ahead of " << n << " frames");
      CHECK_THAT(predicted[static_cast<std::size_t>(n - 1 + steps)].patch(6).position.y,
                 test::WithinAbs(expected, 1e-3));
    }
  }
}

TEST_CASE("A frame's prediction has the patches of the frame before", "[predict]") {
  const auto scene = swaying(10);
  const auto truth = test::make(scene, 33);
  const auto predicted = mcmc::predict(model_of(scene), truth.motion);
  for (std::size_t t = 1; t < 10; ++t) {
    const auto& before = truth.motion.sketch.frames[t - 1];
    REQUIRE(predicted[t].size() == before.size());
    CHECK(std::ranges::equal(predicted[t].edges(), before.edges()));
    for (std::size_t v = 0; v < before.size(); ++v) {
      auto patch = predicted[t].patch(v);
      patch.position = before.patch(v).position;
      CHECK(patch == before.patch(v));
      CHECK(predicted[t].vertices()[v].id == before.vertices()[v].id);
    }
  }
}

TEST_CASE("A prediction knows nothing of what it predicts", "[predict]") {
  const auto scene = swaying(20);
  const auto truth = test::make(scene, 34);
  const auto model = model_of(scene);
  const auto all = mcmc::predict(model, truth.motion);
  for (const std::size_t t : {1, 7, 15}) {
    // Frames from t on are moved, and the last ones left out.
    auto other = truth.motion;
    for (std::size_t k = t; k < other.sketch.frames.size(); ++k) {
      const auto& graph = other.sketch.frames[k];
      std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
      for (auto& v : vertices) v.patch.position = v.patch.position + Point{3, -2.5}, v.patch.contrast *= 2;
      other.sketch.frames[k] = {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
    }
    other.sketch.frames.resize(18), other.links.resize(18);
    const auto changed = mcmc::predict(model, other);
    for (std::size_t k = 0; k <= t; ++k) CHECK(changed[k] == all[k]);
    CHECK(changed[t + 1] != all[t + 1]);
  }
}

TEST_CASE("Predicting nothing and with a model that is none", "[predict]") {
  auto model = test::empty_model();
  CHECK(mcmc::predict(model, {}).empty());
  graph::MotionGraph empty;
  empty.sketch.frames.resize(3), empty.links.resize(3);
  for (const auto& graph : mcmc::predict(model, empty)) CHECK(graph.empty());
  // Strokes at rest are predicted at their places.
  auto scene = swaying(5);
  scene.displacement = {}, scene.resampled = false;
  const auto truth = test::make(scene, 35);
  const auto predicted = mcmc::predict(model, truth.motion);
  for (std::size_t v = 0; v < predicted[4].size(); ++v)
    CHECK(graph::distance(predicted[4].patch(v).position, truth.motion.sketch.frames[3].patch(v).position) <
          1e-6);
  model.displacement.a1 = 2;
  CHECK_THROWS_AS(mcmc::predict(model, truth.motion), core::InputError);
}
