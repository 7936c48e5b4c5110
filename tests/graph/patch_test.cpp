// SPDX-License-Identifier: Apache-2.0
#include "graph/patch.hpp"

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("Every patch type has a name that leads back to it", "[graph][patch]") {
  for (int i = 0; i <= static_cast<int>(graph::PatchType::anchor); ++i) {
    const auto type = static_cast<graph::PatchType>(i);
    CHECK(graph::patch_type(graph::name(type)) == type);
  }
  CHECK_FALSE(graph::patch_type("no such type"));
}
