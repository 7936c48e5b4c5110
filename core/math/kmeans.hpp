// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/rng.hpp"

// k-means with k-means++ seeds (Arthur & Vassilvitskii 2007). A point is a random-access range of floats; all
// points have one size.
namespace emberfold::core {

/// Returns the squared Euclidean distance of two points, single precision, in eight partial sums.
template <class Point>
float squared_distance(const Point& a, const Point& b) {
  constexpr std::size_t kLanes = 8;  // one vector register of floats
  std::array<float, kLanes> lanes{};
  std::size_t i = 0;
  for (; i + kLanes <= a.size(); i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) lanes[k] += (a[i + k] - b[i + k]) * (a[i + k] - b[i + k]);
  float sum = 0;
  for (const float lane : lanes) sum += lane;
  for (; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Returns the number of the nearest centre, the first of equals, and the squared distance to it.
template <class Point>
std::pair<std::uint32_t, float> nearest_centre(const Point& point, const std::vector<Point>& centres) {
  std::pair<std::uint32_t, float> best{0, std::numeric_limits<float>::infinity()};
  for (std::uint32_t k = 0; k < centres.size(); ++k)
    if (const float d = squared_distance(point, centres[k]); d < best.second) best = {k, d};
  return best;
}

/// Draws first centres: one uniformly, each further one with probability by squared distance from those
/// before. Returns fewer than `count` where there are fewer different points. O(points · count).
template <class Point>
std::vector<Point> kmeans_plus_plus(const std::vector<Point>& points, std::size_t count, Rng& rng) {
  std::vector<Point> centres{points[rng.below(static_cast<std::uint32_t>(points.size()))]};
  std::vector<double> nearest(points.size(), std::numeric_limits<double>::infinity());
  while (centres.size() < count) {
    for (std::size_t i = 0; i < points.size(); ++i)
      nearest[i] = std::min(nearest[i], double{squared_distance(points[i], centres.back())});
    if (!(*std::max_element(nearest.begin(), nearest.end()) > 0)) break;
    centres.push_back(points[rng.categorical(nearest)]);
  }
  return centres;
}

/// Holds the state of a clustering after a round of assignments.
template <class Point>
struct KMeans {
  std::vector<Point> centres;
  std::vector<std::uint32_t> owner;  ///< of each point
  double squares = 0;                ///< sum of the squared distances to the owners
  bool changed = true;               ///< whether the last round gave a point another owner
};

/// Improves centres by Lloyd's rounds until `finished`(state) holds after an assignment, `rounds` at most.
/// A centre without points stays where it is. O(rounds · points · centres).
template <class Point, class Finished>
KMeans<Point> lloyd(const std::vector<Point>& points, std::vector<Point> centres, int rounds,
                    const Finished& finished) {
  KMeans<Point> state{std::move(centres), std::vector<std::uint32_t>(points.size(), 0)};
  const std::size_t size = points[0].size();
  for (int round = 0; round < rounds; ++round) {
    state.squares = 0;
    state.changed = round == 0;
    std::vector<std::vector<double>> sums(state.centres.size(), std::vector<double>(size, 0.0));
    std::vector<double> members(state.centres.size(), 0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [k, squared] = nearest_centre(points[i], state.centres);
      state.changed = state.changed || state.owner[i] != k;
      state.owner[i] = k;
      state.squares += double{squared};
      members[k] += 1;
      for (std::size_t j = 0; j < size; ++j) sums[k][j] += double{points[i][j]};
    }
    if (finished(std::as_const(state))) break;
    for (std::size_t k = 0; k < sums.size(); ++k)
      for (std::size_t j = 0; j < size; ++j)
        if (members[k] > 0) state.centres[k][j] = static_cast<float>(sums[k][j] / members[k]);
  }
  return state;
}

}  // namespace emberfold::core
