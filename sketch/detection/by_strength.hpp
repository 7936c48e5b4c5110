// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sketch/detection/creases.hpp"

namespace emberfold::sketch {

/// Returns the points' indices, those with the greatest `value` (≥ 0; compared in single precision) first. Of
/// equal ones the point nearest to the frame's middle comes first, so that a mirrored frame has the mirrored
/// order. Radix sort by digits of eleven bits, the last first: O(n), but for runs of equal values.
inline std::vector<std::size_t> sort_by_strength(const std::vector<CreasePoint>& points,
                                                 double CreasePoint::*value, cv::Size frame) {
  constexpr std::uint32_t kBits = 11, kDigits = 3, kMask = (1U << kBits) - 1;
  struct Key {
    std::uint32_t value, point;
  };
  std::vector<Key> keys(points.size()), sorted(points.size());
  std::array<std::array<std::uint32_t, kMask + 1>, kDigits> first{};  // where each digit's keys begin
  for (std::size_t i = 0; i < keys.size(); ++i) {
    // The order of floats that are not negative is that of their bits.
    const std::uint32_t key = ~std::bit_cast<std::uint32_t>(static_cast<float>(points[i].*value));
    keys[i] = {key, static_cast<std::uint32_t>(i)};
    for (std::uint32_t d = 0; d < kDigits; ++d) ++first[d][key >> (d * kBits) & kMask];
  }
  for (auto& count : first) std::exclusive_scan(count.begin(), count.end(), count.begin(), 0U);
  for (std::uint32_t d = 0; d < kDigits; ++d) {
    for (const Key& key : keys) sorted[first[d][key.value >> (d * kBits) & kMask]++] = key;
    keys.swap(sorted);
  }
  const graph::Point middle{0.5 * (frame.width - 1), 0.5 * (frame.height - 1)};
  const auto nearer = [&](const Key& a, const Key& b) {
    return graph::distance(points[a.point].position, middle) <
           graph::distance(points[b.point].position, middle);
  };
  for (auto run = keys.begin(); run != keys.end();) {
    const auto end = std::find_if(run + 1, keys.end(), [&](const Key& k) { return k.value != run->value; });
    if (end - run > 1) std::stable_sort(run, end, nearer);
    run = end;
  }
  std::vector<std::size_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].point;
  return order;
}

}  // namespace emberfold::sketch
