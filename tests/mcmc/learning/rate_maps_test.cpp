// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/operator_rates.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("Where as many die as are expected the map is 1, and where twice as many do it is above",
          "[rates]") {
  mcmc::OperatorCounts counts;
  const auto grid = mcmc::make_cell_grid(320, 240);
  counts.gaps = 10;
  counts.expected_deaths = counts.expected_separations = grid;
  for (double& value : counts.expected_deaths.values) value = 10;
  mcmc::CellMap each = grid;
  std::ranges::fill(each.values, 1.0);
  counts.births.assign(10, each), counts.separations.assign(10, grid);
  SECTION("everywhere") {
    counts.deaths.assign(10, each);
    for (const double value : mcmc::estimate_rates(counts).rates.death.values)
      CHECK_THAT(value, WithinAbs(1, 1e-9));
  }
  SECTION("twice as many on the left") {
    for (std::size_t c = 0; c < each.values.size(); ++c)
      each.values[c] = c % std::size_t(each.columns) < std::size_t(each.columns) / 2 ? 2 : 1;
    counts.deaths.assign(10, each);
    const auto map = mcmc::estimate_rates(counts).rates.death;
    CHECK_THAT(map.at({16, 120}), WithinAbs(2, 0.1));
    CHECK_THAT(map.at({304, 120}), WithinAbs(1, 0.1));
  }
}
