// SPDX-License-Identifier: Apache-2.0
#include "graph/io/motion_io.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

FUZZ_TARGET(events)(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size, "file", [](std::istream& in) { return graph::read_events(in, "file"); },
      [](std::ostream& out, const std::vector<graph::Event>& value) { graph::write_events(out, value); });
}
