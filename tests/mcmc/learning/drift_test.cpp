// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/drift.hpp"

#include <numbers>
#include <numeric>

#include "tests/support/catch.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;
using graph::Point;

namespace {

mcmc::Drift drift_of(const test::Scene& scene, std::uint64_t seed) {
  const auto truth = test::make(scene, seed);
  return mcmc::estimate_drift(mcmc::detail::track_curves(truth.motion),
                              mcmc::make_cell_grid(scene.width, scene.height));
}

test::Scene scattered(int frames) {
  test::Scene scene;
  scene.frames = frames;
  scene.strokes = test::scattered(6, 4, scene.width, scene.height, 45);
  scene.displacement = {1.3, -0.45, 0.35, 30};  // SD 0.8 px
  return scene;
}

double total(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

TEST_CASE("A drift that is the same everywhere is recovered under a sway", "[drift]") {
  const Point v = GENERATE(Point{0.6, -0.4}, Point{-0.25, 0}, Point{0, 1.1});
  auto scene = scattered(40);
  scene.drift = [v](Point) { return v; };
  const auto drift = drift_of(scene, 3);
  // At strokes. Displacements of 0.8 px make a mean speed over 40 frames uncertain by about 0.03 px; each
  // cell has some ten tracks.
  for (double y = 30; y < 210; y += 20)
    for (double x = 30; x < 290; x += 20) {
      CHECK_THAT(drift.at({x, y}).x, Catch::Matchers::WithinAbs(v.x, 0.08));
      CHECK_THAT(drift.at({x, y}).y, Catch::Matchers::WithinAbs(v.y, 0.08));
    }
}

TEST_CASE("Two halves of a frame drift differently", "[drift]") {
  auto scene = scattered(40);
  scene.drift = [](Point p) { return p.x < 160 ? Point{0, 0.5} : Point{0, -0.5}; };
  const auto drift = drift_of(scene, 4);
  for (double y = 40; y < 210; y += 20)
    for (const double x : {20.0, 40.0, 60.0}) {
      // Nearness has an SD of 32 px.
      CHECK_THAT(drift.at({x, y}).y, Catch::Matchers::WithinAbs(0.5, 0.12));
      CHECK_THAT(drift.at({319 - x, y}).y, Catch::Matchers::WithinAbs(-0.5, 0.12));
      CHECK_THAT(drift.at({x, y}).x, Catch::Matchers::WithinAbs(0, 0.12));
    }
}

TEST_CASE("A sway about rest is no drift", "[drift]") {
  const auto drift = drift_of(scattered(100), 5);
  for (std::size_t c = 0; c < drift.x.values.size(); ++c) {
    CHECK(std::abs(drift.x.values[c]) < 0.03);
    CHECK(std::abs(drift.y.values[c]) < 0.03);
  }
}

TEST_CASE("Curves of one direction tell nothing of a drift along them", "[drift]") {
  test::Scene scene;
  scene.frames = 30;
  for (int i = 0; i < 8; ++i) scene.strokes.push_back({{40.0 + 30 * i, 60}, std::numbers::pi / 2, 120});
  scene.drift = [](Point) { return Point{0.5, 0.8}; };
  const auto drift = drift_of(scene, 6);
  CHECK_THAT(drift.at({160, 120}).x, Catch::Matchers::WithinAbs(0.5, 0.05));
  CHECK_THAT(drift.at({160, 120}).y, Catch::Matchers::WithinAbs(0, 0.05));
}

TEST_CASE("Nothing seen is no drift", "[drift]") {
  const auto grid = mcmc::make_cell_grid(100, 60);
  const auto drift = mcmc::estimate_drift({}, grid);
  CHECK(total(drift.x.values) == 0);
  CHECK(total(drift.y.values) == 0);
}

TEST_CASE("A grid covers its frame", "[drift]") {
  for (const auto& [width, height] : {std::pair{1, 1}, {16, 16}, {17, 300}, {320, 240}, {3000, 20}}) {
    const auto grid = mcmc::make_cell_grid(width, height);
    CHECK(grid.columns * grid.cell >= width);
    CHECK((grid.columns - 1) * grid.cell < width);
    CHECK(grid.rows * grid.cell >= height);
    CHECK((grid.rows - 1) * grid.cell < height);
    CHECK(grid.values.size() == static_cast<std::size_t>(grid.columns * grid.rows));
    CHECK(grid.columns <= 49);
    // Pixel centres are at integers: the first cell begins at −1/2. What lies outside is in the nearest cell.
    CHECK(grid.index({-0.5, -0.5}) == 0);
    CHECK(grid.index({-1000, -3}) == 0);
    CHECK(grid.index({width + 1e6, height + 1e6}) == grid.values.size() - 1);
    CHECK(grid.index({grid.cell - 0.51, 0}) == 0);
    if (grid.columns > 1) CHECK(grid.index({grid.cell - 0.49, 0}) == 1);
    if (grid.rows > 1) CHECK(grid.index({0, grid.cell - 0.49}) == static_cast<std::size_t>(grid.columns));
  }
}

TEST_CASE("Spreading keeps the mass and spreads it evenly", "[drift]") {
  mcmc::CellMap map = mcmc::make_cell_grid(320, 240);
  const auto columns = static_cast<std::size_t>(map.columns);
  for (const double sigma : {0.5, 1.0, 2.0, 5.0, 16.0}) {
    for (const Point p : {Point{160, 120}, Point{0, 0}, Point{319, 100}, Point{20, 239}}) {
      auto one = map;
      one.values[one.index(p)] = 3;
      const auto out = mcmc::spread_over_cells(one, sigma);
      CHECK_THAT(total(out), Catch::Matchers::WithinRel(3.0, 1e-12));
      for (const double value : out) CHECK(value >= 0);
      CHECK(out[one.index(p)] == *std::max_element(out.begin(), out.end()));
    }
  }
  // In the middle it is a Gaussian: its second moment is sigma².
  auto one = map;
  one.values[one.index({160, 120})] = 1;
  const auto out = mcmc::spread_over_cells(one, 1.5);
  double mean_x = 0, mean_y = 0, xx = 0, yy = 0;
  for (std::size_t c = 0; c < out.size(); ++c) {
    const double x = double(c % columns), y = double(c / columns);
    mean_x += out[c] * x, mean_y += out[c] * y, xx += out[c] * x * x, yy += out[c] * y * y;
  }
  CHECK_THAT(mean_x, Catch::Matchers::WithinAbs(double(map.index({160, 0})), 1e-9));
  CHECK_THAT(mean_y, Catch::Matchers::WithinAbs(double(map.index({0, 120}) / columns), 1e-9));
  CHECK_THAT(xx - mean_x * mean_x, Catch::Matchers::WithinRel(2.25, 0.03));
  CHECK_THAT(yy - mean_y * mean_y, Catch::Matchers::WithinRel(2.25, 0.03));
  // No width, no spread; and it is linear.
  CHECK(mcmc::spread_over_cells(one, 0) == one.values);
  auto twice = one;
  for (double& value : twice.values) value *= 2;
  const auto doubled = mcmc::spread_over_cells(twice, 1.5);
  for (std::size_t c = 0; c < out.size(); ++c)
    CHECK_THAT(doubled[c], Catch::Matchers::WithinAbs(2 * out[c], 1e-12));
}
