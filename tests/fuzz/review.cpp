// SPDX-License-Identifier: Apache-2.0
#include "graph/io/review_io.hpp"
#include "tests/fuzz/check.hpp"

using namespace emberfold;

FUZZ_TARGET(review)(const std::uint8_t* data, std::size_t size) {
  return fuzz::round_trip(
      data, size, "file", [](std::istream& in) { return graph::read_review(in, "file"); },
      [](std::ostream& out, const std::vector<graph::ReviewedEvent>& value) {
        graph::write_review(out, value);
      });
}
