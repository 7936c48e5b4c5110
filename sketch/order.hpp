// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sketch/creases.hpp"

namespace emberfold::sketch {

/// The points' indices, those with the greatest `value` (≥ 0; compared in single precision) first; equal ones
/// in their order. O(n): by digits of eleven bits, the last first.
inline std::vector<std::size_t> strongest_first(const std::vector<CreasePoint>& points,
                                                double CreasePoint::*value) {
  constexpr std::uint32_t kBits = 11, kDigits = 3, kMask = (1U << kBits) - 1;
  struct Key {
    std::uint32_t value, point;
  };
  std::vector<Key> keys(points.size()), sorted(points.size());
  std::array<std::array<std::uint32_t, kMask + 1>, kDigits> first{};  // of each digit's keys, at last
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
  std::vector<std::size_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].point;
  return order;
}

}  // namespace emberfold::sketch
