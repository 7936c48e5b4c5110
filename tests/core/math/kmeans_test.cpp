// SPDX-License-Identifier: Apache-2.0
#include "core/math/kmeans.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using PlanePoint = std::array<float, 2>;

/// Four heaps about the corners of a square, of so many points each.
std::vector<PlanePoint> heaps(int each, core::Rng& rng) {
  std::vector<PlanePoint> points;
  for (int i = 0; i < 4 * each; ++i) {
    const auto near = [&](int side) { return static_cast<float>(100 * side + rng.uniform(-1, 1)); };
    points.push_back({near(i % 2), near(i / 2 % 2)});
  }
  return points;
}

}  // namespace

TEST_CASE("The first centres lie in different heaps, far apart from all before") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    core::Rng rng(seed);
    const auto points = heaps(25, rng);
    std::set<std::pair<bool, bool>> heap;
    for (const auto& centre : core::kmeans_plus_plus(points, 4, rng))
      heap.emplace(centre[0] > 50, centre[1] > 50);
    CHECK(heap.size() == 4);
  }
}

TEST_CASE("There are no more centres than different points") {
  core::Rng rng(1);
  const std::vector<PlanePoint> points{{1, 1}, {2, 2}, {1, 1}, {2, 2}, {2, 2}};
  CHECK(core::kmeans_plus_plus(points, 4, rng).size() == 2);
}

TEST_CASE("Rounds of k-means end at the means of the heaps, with their squares") {
  core::Rng rng(7);
  const auto points = heaps(20, rng);
  const auto state = core::lloyd(points, core::kmeans_plus_plus(points, 4, rng), 20,
                                 [](const auto& now) { return !now.changed; });
  double squares = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<double, 2> mean{};
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j % 4 == i % 4)
        for (std::size_t k = 0; k < 2; ++k) mean[k] += double{points[j][k]} / 20;
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK_THAT(double{state.centres[state.owner[i]][k]}, WithinAbs(mean[k], 1e-4));
      squares += std::pow(double{points[i][k]} - mean[k], 2);
    }
  }
  CHECK_THAT(state.squares, WithinAbs(squares, 1e-2));
  CHECK(!state.changed);
}

TEST_CASE("The squared distance counts every coordinate once, and the first of equal centres is taken") {
  for (std::size_t size = 1; size <= 20; ++size) {
    std::vector<float> a(size), b(size);
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) {
      a[i] = static_cast<float>(i * i % 7), b[i] = static_cast<float>(3 * i % 11);
      sum += std::pow(double{a[i]} - double{b[i]}, 2);
    }
    CHECK_THAT(double{core::squared_distance(a, b)}, WithinAbs(sum, 1e-3));
    CHECK(core::nearest_centre(a, {b, a, a}).first == (sum > 0 ? 1U : 0U));
  }
}
