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

// The order of numbers that are not negative is that of their bits: the sign, the exponent and three bits of
// the fraction tell the bin.
std::size_t bin_of(float value) {
  return std::bit_cast<std::uint32_t>(std::abs(value)) >> 20U;
}

}  // namespace

float median_of_positive(std::vector<float> values) {
  // Counting finds the bin in which the median lies, at a fraction of what partitioning everything costs.
  // Four counters take turns: neighbours often lie in one bin.
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
