// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/velocity_modes.hpp"

#include <cmath>
#include <numbers>

#include "core/rng.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/motion_models.hpp"

using namespace emberfold;
using graph::Point;
using mcmc::VelocityModes;

namespace {

constexpr int kFrames = 200;

/// Velocities of a whole picture, px a frame: x remembers .8 of itself, y nothing; SD 3 and 1.
std::vector<Point> shaken(std::uint64_t seed) {
  core::Rng rng(seed);
  std::vector<Point> result;
  double x = 0;
  for (int t = 0; t + 1 < kFrames; ++t) {
    x = 0.8 * x + 0.6 * rng.normal();
    result.push_back({3 * x, rng.normal()});
  }
  return result;
}

/// Tracks all over the picture that are carried by these velocities, each seen across a curve of some
/// direction.
std::vector<mcmc::detail::CurveTrack> carried(const std::vector<Point>& velocities,
                                              const mcmc::CellMap& grid) {
  std::vector<mcmc::detail::CurveTrack> tracks;
  core::Rng rng(3);
  for (int y = 0; y < grid.rows; ++y)
    for (int x = 0; x < grid.columns; ++x)
      for (int k = 0; k < 4; ++k) {
        const double angle = rng.uniform(0, std::numbers::pi);
        mcmc::detail::CurveTrack track;
        mcmc::detail::TrackSample sample;
        sample.position = Point{x + 0.5, y + 0.5} * grid.cell;
        sample.normal = {std::cos(angle), std::sin(angle)};
        track.samples.push_back(sample);
        for (const Point v : velocities) {
          sample.normal_displacement += graph::dot(v, sample.normal);
          track.samples.push_back(sample);
        }
        tracks.push_back(std::move(track));
      }
  return tracks;
}

Point mean(const std::vector<Point>& points) {
  Point sum;
  for (const Point p : points) sum = sum + p;
  return sum * (1 / static_cast<double>(points.size()));
}

}  // namespace

TEST_CASE("What shakes all strokes alike is learned", "[velocity]") {
  const auto grid = mcmc::make_cell_grid(160, 96);
  const auto truth = shaken(1);
  const auto tracks = carried(truth, grid);
  const auto velocities = mcmc::estimate_velocities(tracks, grid, kFrames);
  REQUIRE(velocities.size() == truth.size());
  const Point middle{80, 48}, average = mean(truth);
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const Point off = velocities[t].at(middle) - (truth[t] - average);
    CHECK(graph::norm(off) < 0.15 * graph::norm(truth[t] - average) + 0.05);
  }
  const VelocityModes modes = mcmc::learn_velocity_modes(velocities);
  CHECK(modes.count == 2);  // x, then y: 90 and 10 % of the energy
  CHECK_THAT(modes.step[0], Catch::Matchers::WithinAbs(0.8, 0.1));
  CHECK_THAT(modes.step[3], Catch::Matchers::WithinAbs(0.0, 0.15));

  // A still sway leaves all of it to the modes, one that moves as much nothing.
  mcmc::MotionModel model = test::empty_model(160, 96);
  for (double& value : model.drift_x.values) value = average.x;
  for (double& value : model.drift_y.values) value = average.y;
  model.displacement.noise = 0;
  const auto all = mcmc::besides_sway(modes, tracks, model);
  CHECK_THAT(all.modes[0], Catch::Matchers::WithinRel(modes.modes[0], 1e-9));
  model.displacement = {0, 0, 0, 1, 0, 0};  // steps of variance 2; of the tracks' 10 / 2 are seen
  const auto most = mcmc::besides_sway(modes, tracks, model);
  CHECK_THAT(std::pow(most.modes[0] / modes.modes[0], 2), Catch::Matchers::WithinAbs(1 - 2 / 5.0, 0.12));
  model.displacement.noise = 1.6;
  CHECK(mcmc::besides_sway(modes, tracks, model).count == 0);
}

TEST_CASE("Few fields, and pictures in which nothing moves, have no modes", "[velocity]") {
  const auto grid = mcmc::make_cell_grid(160, 96);
  const auto still = mcmc::estimate_velocities(carried(std::vector<Point>(kFrames - 1), grid), grid, kFrames);
  CHECK(mcmc::learn_velocity_modes(still).count == 0);
  const auto few = shaken(2);
  CHECK(mcmc::learn_velocity_modes(
            mcmc::estimate_velocities(carried({few.begin(), few.begin() + 7}, grid), grid, 8))
            .count == 0);
}

TEST_CASE("Backwards twice is forwards, and once is the exact reversal", "[velocity]") {
  const auto model = test::full_model();
  VelocityModes modes = model.velocity;
  modes.step = {0.6, 0.3, -0.3, 0.6};
  const auto there = mcmc::reverse_modes(modes);
  // With a covariance of I the lag-one covariance of the reversed process is the transpose.
  CHECK(there.step == std::vector<double>{0.6, -0.3, 0.3, 0.6});
  CHECK(there.modes[1] == -modes.modes[1]);
  const auto back = mcmc::reverse_modes(there);
  CHECK(back.step == modes.step);
  CHECK(back.modes == modes.modes);
  for (const auto& one : {there, back}) {
    auto checked = model;
    checked.velocity = one;
    CHECK_NOTHROW(mcmc::validate(checked));
  }
}

TEST_CASE("Drawn strokes are carried as the modes say, faster and slower", "[velocity]") {
  auto model = test::empty_model();
  test::Frame frame;
  frame.line(test::segment({100, 120}, {220, 120}, 25));
  model.first = frame.graph();
  model.velocity = {1, {}, {0.6}, {0.8}};
  for (std::size_t c = 0; c < model.drift_x.values.size(); ++c)
    model.velocity.modes.insert(model.velocity.modes.end(), {0, 0.5});  // along y alone
  for (const double pace : {1.0, 2.0}) {
    model.rates.modifiers.pace = pace;
    mcmc::Synthesis synthesis(model, 5);
    double before = synthesis.next().patch(12).position.y, square = 0, product = 0, step_before = 0;
    constexpr int kDrawn = 1000;
    for (int t = 0; t < kDrawn; ++t) {
      const auto graph = synthesis.next();
      CHECK_THAT(graph.patch(12).position.x, Catch::Matchers::WithinAbs(160, 1e-6));
      const double step = graph.patch(12).position.y - before;
      square += step * step / kDrawn, product += step * step_before / kDrawn;
      before = graph.patch(12).position.y, step_before = step;
    }
    // A twentieth of what carried it is taken back in each frame, so steps are a little shorter and less
    // alike.
    CHECK_THAT(std::sqrt(square), Catch::Matchers::WithinRel(0.5 * pace, 0.12));
    CHECK_THAT(product / square, Catch::Matchers::WithinAbs(std::pow(0.6, pace), 0.12));
    CHECK_THAT(before, Catch::Matchers::WithinAbs(120, 30));  // near its place after a thousand frames
  }
}
