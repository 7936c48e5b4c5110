// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace emberfold::core {

/// SD of normally distributed values by their median absolute deviation: 1 / Φ⁻¹(3/4).
inline constexpr double kMadToSd = 1.4826;

/// Returns the element at `rank` (0 … size − 1) in ascending order; reorders the values. O(n).
template <class T>
T order_statistic(std::vector<T>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Returns the upper median, element size / 2 in ascending order, of at least one value. O(n).
template <class T>
T median(std::vector<T> values) {
  return order_statistic(values, values.size() / 2);
}

/// Returns the upper median of at least one value, all ≥ 0; faster than median() for many. O(n).
float median_of_positive(std::vector<float> values);

}  // namespace emberfold::core
