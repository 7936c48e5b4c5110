// SPDX-License-Identifier: Apache-2.0
#include "core/rng.hpp"

#include "tests/catch.hpp"

using namespace emberfold;

TEST_CASE("Philox gives the published answer for counter 0 and key 0", "[core][rng]") {
  CHECK(core::philox4x32({0, 0, 0, 0}, {0, 0}) ==
        std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
}
