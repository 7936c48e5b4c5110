// SPDX-License-Identifier: Apache-2.0
#include "graph/io/motion_io.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

FUZZ_TARGET(sketch)(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size, "file", [](std::istream& in) { return graph::read_sketch(in, "file"); },
      [](std::ostream& out, const graph::SketchSequence& value) { graph::write_sketch(out, value); });
}
