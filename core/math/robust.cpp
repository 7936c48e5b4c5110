// SPDX-License-Identifier: Apache-2.0
#include "core/math/robust.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace emberfold::core {

namespace {

/// Returns the bin of a number ≥ 0: sign, exponent and three bits of the fraction, which keep its order.
std::size_t bin_of(float value) {
  return std::bit_cast<std::uint32_t>(std::abs(value)) >> 20U;
}

}  // namespace

float median_of_positive(std::vector<float> values) {
  // Counting finds the median's bin faster than partitioning all values. Four tables of counts take turns,
  // since neighbours often fall into one bin.
  std::array<std::array<std::uint32_t, 2048>, 4> counts{};
  for (std::size_t i = 0; i < values.size(); ++i) ++counts[i % 4][bin_of(values[i])];
  const auto count = [&](std::size_t b) {
    return std::size_t{counts[0][b]} + counts[1][b] + counts[2][b] + counts[3][b];
  };
  std::size_t rank = values.size() / 2, bin = 0;
  for (std::size_t here; rank >= (here = count(bin)); ++bin) rank -= here;
  std::erase_if(values, [&](float value) { return bin_of(value) != bin; });
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace emberfold::core
