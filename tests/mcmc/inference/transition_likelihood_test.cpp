// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/transition_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "graph/events/events.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/inference/path_likelihood.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using graph::EventType;
using mcmc::detail::CurveTrack;
using mcmc::detail::FollowedAttribute;

namespace {

std::size_t class_index(EventType type) {
  return static_cast<std::size_t>(type);
}

// log ∫ N(values; rest, C) d rest, by the whole covariance matrix of an AR(2) that is seen with an error.
double dense_log_likelihood(const std::vector<double>& values, double a1, double a2, double noise,
                            double error) {
  const auto n = static_cast<Eigen::Index>(values.size());
  VectorXd c(std::max<Eigen::Index>(n, 2));
  c[0] = noise * (1 - a2) / ((1 + a2) * ((1 - a2) * (1 - a2) - a1 * a1)), c[1] = c[0] * a1 / (1 - a2);
  for (Eigen::Index k = 2; k < n; ++k) c[k] = a1 * c[k - 1] + a2 * c[k - 2];
  MatrixXd m(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) m(i, j) = c[std::abs(i - j)] + (i == j ? error : 0);
  const Eigen::LLT<MatrixXd> factor(m);
  const VectorXd one = VectorXd::Ones(n), y = Eigen::Map<const VectorXd>(values.data(), n);
  const VectorXd weights = factor.solve(one);
  const double information = one.dot(weights);
  const VectorXd off = y - weights.dot(y) / information * one;
  const double log_det = 2 * MatrixXd(factor.matrixL()).diagonal().array().log().sum();
  return -0.5 * (log_det + std::log(information) + double(n - 1) * std::log(2 * std::numbers::pi) +
                 off.dot(factor.solve(off)));
}

std::vector<double> random_values(std::uint64_t seed, int count) {
  core::Rng rng(seed);
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(7 + rng.normal());
  return values;
}

CurveTrack track_of(int first, std::size_t frames) {
  return {first, std::vector<mcmc::detail::TrackSample>(frames)};
}

graph::MotionGraph identified(
    const std::vector<graph::AttributeGraph>& frames,
    const std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>& links) {
  return graph::identify(test::motion(frames, links));
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> straight_links(std::uint32_t count) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t i = 0; i < count; ++i) links.emplace_back(i, i);
  return links;
}

graph::AttributeGraph lines(int upper, int lower) {
  test::Frame frame;
  if (upper > 0) frame.line(test::segment({50, 50}, {50 + 5. * (upper - 1), 50}, upper));
  if (lower > 0) frame.line(test::segment({50, 150}, {50 + 5. * (lower - 1), 150}, lower));
  return frame.graph();
}

mcmc::MotionModel lively_model() {
  auto model = test::coming_and_going(9, 20, 2, 0.03);
  model.displacement = {1.4, -0.6, 0, 0.3, 20, 0};
  model.contrast = {0.8, 0, 0, 0.05, 20, 0};
  return model;
}

double mean_total(const mcmc::MotionModel& model, const graph::MotionGraph& motion) {
  return mcmc::mean_transition(mcmc::transition_likelihoods(model, motion)).total;
}

}  // namespace

TEST_CASE("densities of a path multiply to that of the whole path", "[likelihood]") {
  const mcmc::Autoregression law{1.3, -0.5, 0, 0.4, 0, 0.2};
  for (const int count : {2, 3, 9, 40}) {
    const auto values = random_values(11, count);
    const FollowedAttribute seen{{values}, {1.5}, true, 0.02};
    const auto gaps = mcmc::detail::path_log_densities({track_of(1, values.size())}, {}, seen, law, 50);
    double sum = 0;
    for (const double gap : gaps) sum += gap;
    CHECK(gaps[0] == 0);
    CHECK(sum == Approx(dense_log_likelihood(values, 1.3, -0.5, 0.36, 0.04 + 0.0004)));
    // Those of its beginning are the first ones.
    const std::vector<double> begun(values.begin(), values.end() - 1);
    const auto fewer = mcmc::detail::path_log_densities({track_of(1, begun.size())}, {},
                                                        {{begun}, {1.5}, true, 0.02}, law, 50);
    for (std::size_t t = 0; t + 1 < begun.size(); ++t) CHECK(fewer[t] == Approx(gaps[t]));
  }
}

TEST_CASE("neighbours that move alike do not pull, others do", "[likelihood]") {
  const mcmc::Autoregression free{1.3, -0.5, 0, 0.4, 0, 0.2}, coupled{1.3, -0.5, 0.2, 0.4, 0, 0.2};
  const auto values = random_values(4, 12), others = random_values(5, 12);
  const std::vector<CurveTrack> two{track_of(0, 12), track_of(0, 12)};
  mcmc::detail::TrackNeighbours beside;
  beside.frames.assign(12, {{0, 1, 1}});
  const auto densities = [&](const std::vector<double>& second, const mcmc::Autoregression& law) {
    return mcmc::detail::path_log_densities(two, beside, {{values, second}, {1, 1}, true, 0.02}, law, 12);
  };
  CHECK(densities(values, coupled) == densities(values, free));
  CHECK(densities(others, coupled)[3] != Approx(densities(others, free)[3]));
}

TEST_CASE("neighbours whose normals are opposite do not pull where they move alike in the frame",
          "[likelihood]") {
  const mcmc::Autoregression free{1.3, -0.5, 0, 0.4, 0, 0.2}, coupled{1.3, -0.5, 0.2, 0.4, 0, 0.2};
  const auto values = random_values(4, 12);
  auto opposite = values;
  for (double& value : opposite) value = -value;
  const std::vector<CurveTrack> two{track_of(0, 12), track_of(0, 12)};
  mcmc::detail::TrackNeighbours beside;
  beside.frames.assign(12, {{0, 1, -1}});
  const auto densities = [&](const std::vector<double>& second, const mcmc::Autoregression& law, bool turns) {
    return mcmc::detail::path_log_densities(two, beside, {{values, second}, {1, 1}, turns, 0.02}, law, 12);
  };
  const auto alike = densities(opposite, coupled, true), alone = densities(opposite, free, true);
  for (std::size_t t = 0; t < alike.size(); ++t) CHECK_THAT(alike[t], test::WithinAbs(alone[t], 1e-12));
  // What has no sense, as contrast has none, is alike where it is the same.
  CHECK(densities(values, coupled, false) == densities(values, free, false));
  CHECK(std::abs(densities(values, coupled, true)[3] - densities(values, free, true)[3]) > 1e-6);
}

TEST_CASE("what is followed is less its drift, and less what a young stroke shows of its contrast",
          "[likelihood]") {
  auto model = test::empty_model();
  model.drift_x = test::map_over(320, 240, 16, 0.5), model.drift_y = test::map_over(320, 240, 16, 2);
  model.displacement_scale = test::map_over(320, 240, 16, 1.5);
  model.appearing = {0.25, 0.5, 0.75, 0.001, 1, 1, 1, 1};
  std::vector<CurveTrack> tracks{track_of(0, 5), track_of(3, 5)};
  for (auto& track : tracks)
    for (std::size_t k = 0; k < 5; ++k) {
      track.samples[k].normal = {0.6, 0.8};
      track.samples[k].position = {50, 60};
      track.samples[k].normal_displacement = 3.0 * static_cast<double>(k);
      track.samples[k].contrast = 2;
    }
  const auto moved = mcmc::detail::followed_displacement(tracks, model);
  const auto shone = mcmc::detail::followed_contrast(tracks, model);
  CHECK(moved.turns_with_normal);
  CHECK(!shone.turns_with_normal);
  CHECK(moved.scales == std::vector<double>(2, 1.5));
  for (std::size_t k = 0; k < 5; ++k) {
    // 0.6 · 0.5 + 0.8 · 2 px a frame
    CHECK_THAT(moved.values[0][k], test::WithinAbs((3 - 1.9) * static_cast<double>(k), 1e-12));
    CHECK_THAT(shone.values[0][k], test::WithinAbs(2, 1e-12));
    CHECK_THAT(shone.values[1][k], test::WithinAbs(2 - std::log(std::max(model.appearing[k], 0.01)), 1e-12));
  }
}

TEST_CASE("a union is as likely as its gap's width, the time since a parting and the turn make it",
          "[likelihood]") {
  auto model = test::empty_model();
  model.rates.merge = 0.02, model.rates.connect = 0.01;
  model.rates.modifiers.bridging = {1, 2, 3, 5, 7, 11};
  model.rates.modifiers.unification = {1, 1, 1, 1, 1, 0.5};  // of a parting long ago, or none
  model.rates.modifiers.turning = {13, 17, 19, 23};
  for (const auto& [gap, multiple] :
       {std::pair(4.0, 1.0), {6.0, 2.0}, {9.0, 3.0}, {12.0, 5.0}, {22.0, 11.0}}) {
    test::Frame frame;
    frame.line(test::segment({50, 50}, {90, 50}, 9));
    frame.line(test::segment({90 + gap, 50}, {130 + gap, 50}, 9));
    frame.line(test::segment({50, 150}, {90, 150}, 9));
    frame.line(test::segment({89, 150 + gap}, {89, 190 + gap}, 9));  // a turn by more than a right angle
    const auto motion = identified({frame.graph(), frame.graph()}, {straight_links(36)});
    const auto events = mcmc::transition_likelihoods(model, motion).at(0).events;
    CHECK_THAT(events[class_index(EventType::merge)], test::WithinAbs(-0.001 - 0.02 * 0.5 * multiple, 1e-12));
    CHECK_THAT(events[class_index(EventType::connect)],
               test::WithinAbs(-0.001 - 0.01 * 0.5 * multiple * 23, 1e-12));
  }
}

TEST_CASE("terms of events are those counted by hand", "[likelihood]") {
  auto model = test::empty_model();
  model.rates.death_by_size.fill(0.02);
  model.rates.death_by_size[mcmc::size_class(12)] = 0.1;
  model.rates.birth_by_size[mcmc::size_class(12)] = 1;
  for (double& value : model.rates.birth.values) value = 1e-5;
  model.rates.split = 0.01;
  model.rates.modifiers.death[5] = 1.5;  // of strokes of unknown age
  const double births = 1e-5 * 16 * 16 * static_cast<double>(model.rates.birth.values.size());
  // The lower stroke dies in the second gap, another of as many patches is born in the third.
  const auto two = lines(20, 12), one = lines(20, 0);
  const auto motion =
      identified({two, two, one, two}, {straight_links(32), straight_links(20), straight_links(20)});
  const auto gaps = mcmc::transition_likelihoods(model, motion);
  REQUIRE(gaps.size() == 3);
  const auto term = [&](std::size_t gap, EventType type) { return gaps[gap].events[class_index(type)]; };
  CHECK(gaps[1].happened[class_index(EventType::death)] == 1);
  CHECK(term(0, EventType::death) == Approx(std::log(1 - 0.15) + std::log(1 - 0.03)));
  CHECK(term(1, EventType::death) == Approx(std::log(0.15) + std::log(1 - 0.03)));
  CHECK(term(2, EventType::death) == Approx(std::log(1 - 0.03)));
  CHECK(term(0, EventType::birth) == Approx(-births - 0.001));
  CHECK(term(2, EventType::birth) ==
        Approx(-births - 0.001 + std::log(1e-5 + 0.001 / (320 * 240)) + std::log(1.001 / 1.007)));
  // Patches four or more from a free end could have been split: 12 of 20, 4 of 12.
  CHECK(term(0, EventType::split) == Approx(-0.001 - 0.01 * (12 + 4)));
  CHECK(term(2, EventType::split) == Approx(-0.001 - 0.01 * 12));
  for (const auto type : {EventType::merge, EventType::connect, EventType::disconnect})
    CHECK(term(0, type) == Approx(-0.001));
  CHECK(gaps[0].total() == Approx(gaps[0].displacement + gaps[0].contrast + term(0, EventType::death) +
                                  term(0, EventType::birth) + term(0, EventType::split) - 0.003));
}

TEST_CASE("a split is as likely as its site, one elsewhere hardly", "[likelihood]") {
  auto model = test::empty_model();
  model.rates.split = 0.01;
  test::Frame parts;
  parts.line(test::segment({50, 50}, {95, 50}, 10));
  parts.line(test::segment({105, 50}, {145, 50}, 9));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t i = 0; i < 20; ++i)
    if (i != 10) links.emplace_back(i, i < 10 ? i : i - 1);
  const auto motion = identified({lines(20, 0), parts.graph()}, {links});
  const auto gap = mcmc::transition_likelihoods(model, motion).at(0);
  REQUIRE(gap.happened[class_index(EventType::split)] == 1);
  CHECK(gap.events[class_index(EventType::split)] == Approx(std::log(0.01) - 0.001 - 0.12));
  model.rates.split = 0;
  CHECK(mcmc::transition_likelihoods(model, motion).at(0).events[class_index(EventType::split)] ==
        Approx(std::log(0.001) - 0.001));
}

TEST_CASE("a clip of the model is likelier than out of order, and than under other rates", "[likelihood]") {
  const auto model = lively_model();
  const auto motion = mcmc::synthesize(model, 60, 3, {}, mcmc::Start::stationary);
  const double own = mean_total(model, motion);
  graph::SketchSequence shuffled = motion.sketch;
  shuffled.frames.clear();
  for (std::size_t k = 0; k < 60; ++k) shuffled.append(motion.sketch.frames[k * 23 % 60]);
  CHECK(own > mean_total(model, graph::match(shuffled, {.flicker = 0})) + 10);

  for (const double times : {0.1, 8.0}) {
    auto other = model;
    for (double& rate : other.rates.death_by_size) rate *= times;
    for (double& rate : other.rates.birth.values) rate *= times;
    CHECK(own > mean_total(other, motion));
  }
  for (const double times : {0.25, 4.0}) {
    auto other = model;
    other.displacement.noise *= times;
    CHECK(own > mean_total(other, motion) + 10);
  }
}

TEST_CASE("a likelihood refuses graphs of another size, and single frames", "[likelihood]") {
  const auto one = identified({lines(8, 0)}, {});
  const auto message = [](const mcmc::MotionModel& model, const graph::MotionGraph& motion) {
    return test::message_of<core::InputError>([&] { mcmc::transition_likelihoods(model, motion); });
  };
  CHECK(test::contains(message(test::empty_model(100, 60), one), "320x240 px, the model of 100x60"));
  CHECK(test::contains(message(test::empty_model(), one), "two frames or more; here are 1"));
  CHECK_THROWS_AS(mcmc::mean_transition({}), core::InputError);
}
