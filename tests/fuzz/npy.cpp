// SPDX-License-Identifier: Apache-2.0
#include "core/npy.hpp"

#include "tests/fuzz/check.hpp"

using namespace emberfold;

FUZZ_TARGET(npy)(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size, "npy: ", [](std::istream& in) { return core::read_npy(in); },
      [](std::ostream& out, const core::NpyArray& array) { core::write_npy(out, array); });
}
