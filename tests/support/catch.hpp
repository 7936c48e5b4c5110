// SPDX-License-Identifier: Apache-2.0
// Lets one test file compile against Catch2 2 and 3, and names the matchers of most tests.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
namespace Catch::Matchers {
using Catch::Contains;
using Catch::WithinAbs;
using Catch::WithinRel;
}  // namespace Catch::Matchers
#endif

namespace emberfold::test {

using Catch::Matchers::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

}  // namespace emberfold::test
