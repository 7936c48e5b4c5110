// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/filter_bank.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// Weights by (dx, dy), those of the filter turned and mirrored as asked.
std::map<std::pair<int, int>, int> taps(std::string_view name, bool transposed = false, int mirror = 1) {
  const auto filters = sketch::make_texture_filters();
  const auto filter = std::ranges::find(filters, name, &sketch::TextureFilter::name);
  REQUIRE(filter != filters.end());
  std::map<std::pair<int, int>, int> result;
  for (const auto& tap : filter->taps)
    result[transposed ? std::pair(tap.dy, tap.dx) : std::pair(mirror * tap.dx, tap.dy)] = tap.weight;
  return result;
}

}  // namespace

TEST_CASE("Filters of four directions are each other's mirror images") {
  CHECK(taps("bend at 90 degrees") == taps("bend at 0 degrees", true));
  CHECK(taps("bend at 45 degrees") == taps("bend at 45 degrees", true));
  CHECK(taps("bend at 135 degrees") == taps("bend at 45 degrees", false, -1));
  CHECK(taps("slope along y") == taps("slope along x", true));
  CHECK(taps("difference along y") == taps("difference along x", true));
  CHECK(taps("bend at 45 degrees") != taps("bend at 135 degrees"));
}

TEST_CASE("Filters but the level itself do not see a constant") {
  for (const auto& filter : sketch::make_texture_filters()) {
    int sum = 0;
    for (const auto& tap : filter.taps) sum += tap.weight;
    CHECK(sum == (filter.name == "level" ? sketch::kTextureLevel : 0));
  }
}
