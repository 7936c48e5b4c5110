// SPDX-License-Identifier: Apache-2.0
#include "graph/patch.hpp"

#include <numbers>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("Every patch type has a name that leads back to it", "[graph][patch]") {
  for (int i = 0; i <= static_cast<int>(graph::PatchType::anchor); ++i) {
    const auto type = static_cast<graph::PatchType>(i);
    CHECK(graph::patch_type(graph::name(type)) == type);
  }
  CHECK_FALSE(graph::patch_type("no such type"));
}

TEST_CASE("Orientations have no sense and are never farther apart than a right angle", "[graph][patch]") {
  constexpr double pi = std::numbers::pi;
  CHECK_THAT(graph::orientation_difference(0.05, pi - 0.05), test::WithinAbs(0.1, 1e-12));
  CHECK_THAT(graph::orientation_difference(-pi / 2, pi / 2), test::WithinAbs(0, 1e-12));
  CHECK_THAT(graph::orientation_difference(0.3, 0.3 + 7 * pi + 0.2), test::WithinAbs(0.2, 1e-9));
  CHECK_THAT(graph::orientation_difference(0, pi / 2), test::WithinAbs(pi / 2, 1e-12));
}
