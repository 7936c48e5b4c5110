// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "mcmc/model/rate_maps.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("A cell holds the pixels whose squares lie in it, the outermost what is beyond", "[maps]") {
  auto map = mcmc::make_cell_grid(70, 40);
  REQUIRE((map.cell == 16 && map.columns == 5 && map.rows == 3));
  CHECK(map.index({0, 0}) == 0);
  CHECK(map.index({-0.4, 15.4}) == 0);
  CHECK(map.index({15.4, 0}) == 0);
  CHECK(map.index({15.6, 0}) == 1);
  CHECK(map.index({0, 15.6}) == 5);
  CHECK(map.index({63.6, 31.6}) == 14);
  CHECK(map.index({-100, -100}) == 0);
  CHECK(map.index({1000, -100}) == 4);
  CHECK(map.index({1000, 1000}) == 14);
  const auto wide = mcmc::make_cell_grid(960, 100);
  CHECK((wide.cell == 20 && wide.columns == 48 && wide.rows == 5));
}

TEST_CASE("Between the middles of its cells a map is linear, at its border even", "[maps]") {
  auto map = mcmc::make_cell_grid(96, 80);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.values[static_cast<std::size_t>(row * map.columns + column)] =
          3 * (16 * column + 7.5) - 2 * (16 * row + 7.5);
  for (double y = 7.5; y <= 71.5; y += 3.2)
    for (double x = 7.5; x <= 87.5; x += 3.7)
      CHECK_THAT(mcmc::interpolate(map, {x, y}), WithinAbs(3 * x - 2 * y, 1e-9));
  CHECK_THAT(mcmc::interpolate(map, {2, 7.5}), WithinAbs(3 * 7.5 - 2 * 7.5, 1e-9));
  CHECK_THAT(mcmc::interpolate(map, {95, 79}), WithinAbs(3 * 87.5 - 2 * 71.5, 1e-9));
}

TEST_CASE("Spread over cells a map keeps its sum, and falls off as a Gaussian", "[maps]") {
  auto map = mcmc::make_cell_grid(320, 240);
  const auto at = [&](int column, int row) { return static_cast<std::size_t>(row * map.columns + column); };
  map.values[at(0, 0)] = 5, map.values[at(10, 7)] = 1;
  CHECK(mcmc::spread_over_cells(map, 0) == map.values);
  const auto spread = mcmc::spread_over_cells(map, 1.2);
  CHECK_THAT(std::accumulate(spread.begin(), spread.end(), 0.0), WithinAbs(6, 1e-12));
  for (int off = 1; off <= 3; ++off) {
    const double ratio = std::exp(-0.5 * off * off / (1.2 * 1.2));
    CHECK_THAT(spread[at(10 + off, 7)] / spread[at(10, 7)], WithinAbs(ratio, 1e-9));
    CHECK_THAT(spread[at(10, 7 - off)] / spread[at(10, 7)], WithinAbs(ratio, 1e-9));
  }
}

TEST_CASE("Places are drawn evenly within cells that are drawn by their weights", "[maps]") {
  auto map = mcmc::make_cell_grid(64, 48);
  map.values[5] = 1, map.values[10] = 3;  // the second of the second row, the third of the third
  core::Rng rng(2);
  double heavy = 0, x = 0, y = 0;
  constexpr int kDraws = 4000;
  for (int k = 0; k < kDraws; ++k) {
    const auto place = mcmc::draw_place(map, rng);
    const auto cell = map.index(place);
    REQUIRE((cell == 5 || cell == 10));
    if (cell == 5) continue;
    heavy += 1, x += place.x, y += place.y;
  }
  CHECK_THAT(heavy / kDraws, WithinAbs(0.75, 0.03));
  CHECK_THAT(x / heavy, WithinAbs(39.5, 0.4));
  CHECK_THAT(y / heavy, WithinAbs(39.5, 0.4));
}
