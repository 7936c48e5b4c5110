// SPDX-License-Identifier: Apache-2.0
#include "core/math/robust.hpp"

#include <algorithm>
#include <vector>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("The median by counting is the element at half the size in ascending order") {
  core::Rng rng(3);
  for (std::size_t size = 1; size <= 40; ++size)
    for (const double most : {0.0, 1e-3, 1.0, 300.0}) {
      std::vector<float> values(size);
      for (float& value : values) value = static_cast<float>(most * rng.uniform() * rng.uniform());
      auto sorted = values;
      std::ranges::sort(sorted);
      CHECK(core::median_of_positive(values) == sorted[size / 2]);
      CHECK(core::median(values) == sorted[size / 2]);
      CHECK(core::order_statistic(values, size / 3) == sorted[size / 3]);
    }
}
