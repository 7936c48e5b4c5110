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

TEST_CASE("An edge joins outlines where neither step runs along it", "[graph][patch]") {
  constexpr double pi = std::numbers::pi;
  graph::Patch a, b;
  a.position = {10, 10}, b.position = {10, 30};
  const auto joins = [&](double theta_a, double theta_b) {
    a.theta = theta_a, b.theta = theta_b;
    return graph::joins_outlines(a, b) && graph::joins_outlines(b, a);
  };
  CHECK(joins(0, pi));
  CHECK(joins(0.6, -0.6));
  CHECK_FALSE(joins(0, pi / 2));
  CHECK_FALSE(joins(0.8, 0.8));
  b.position = {10, 41};
  CHECK(joins(pi / 2, pi / 2));  // farther apart than any gap
  b.width = 2;                   // a line
  CHECK_FALSE(joins(0, 0));
}

TEST_CASE("Nothing is seen along the border that closes an outline, nor between outlines", "[graph][patch]") {
  constexpr double pi = std::numbers::pi;
  graph::Patch a, b;
  a.theta = b.theta = pi / 2;
  a.position = {10, 10}, b.position = {10, 20};
  const auto seen = [&](double contrast_a, double contrast_b) {
    a.contrast = contrast_a, b.contrast = contrast_b;
    return graph::is_seen(a, b);
  };
  CHECK(seen(30, 30));
  CHECK(seen(30, 0));
  CHECK_FALSE(seen(0, 0));
  b.position = {20, 10};
  CHECK_FALSE(seen(30, 30));
  a.width = b.width = 3;
  CHECK(seen(0, 0));
}
