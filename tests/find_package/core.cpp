// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

int main() {
  const double sum =
      emberfold::core::deterministic_sum(101, 8, [](std::size_t i) { return static_cast<double>(i); });
  return sum == 5050 ? 0 : 1;
}
