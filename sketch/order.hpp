// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sketch/creases.hpp"

namespace emberfold::sketch {

/// The points' indices, those with the greatest `value` (≥ 0; compared in single precision) first; equal ones
/// in their order. O(n log n).
inline std::vector<std::size_t> strongest_first(const std::vector<CreasePoint>& points,
                                                double CreasePoint::*value) {
  // The order of floats that are not negative is that of their bits.
  std::vector<std::uint64_t> keys(points.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
    keys[i] = std::uint64_t{~std::bit_cast<std::uint32_t>(static_cast<float>(points[i].*value))} << 32U | i;
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i] & 0xFFFFFFFFU;
  return order;
}

}  // namespace emberfold::sketch
