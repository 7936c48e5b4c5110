// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/overlap.hpp"

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/hal/interface.h>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

template <class Value>
double difference(const std::vector<Value>& a, const std::vector<Value>& b, int depth) {
  return dytex::detail::squared_difference(std::as_bytes(std::span(a)).data(),
                                           std::as_bytes(std::span(b)).data(), a.size(), depth);
}

/// The same values at each depth.
void check_depths(std::uint32_t count) {
  core::Rng rng(count);
  std::vector<std::uint8_t> bytes[2];
  std::vector<std::uint16_t> words[2];
  std::vector<float> floats[2];
  double expected = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    double values[2];
    for (int side = 0; side < 2; ++side) {
      values[side] = rng.below(256);
      bytes[side].push_back(static_cast<std::uint8_t>(values[side]));
      words[side].push_back(static_cast<std::uint16_t>(257 * values[side]));
      floats[side].push_back(static_cast<float>(values[side]));
    }
    expected += (values[0] - values[1]) * (values[0] - values[1]);
  }
  CHECK(difference(bytes[0], bytes[1], CV_8U) == expected);
  CHECK(difference(words[0], words[1], CV_16U) == 257 * 257 * expected);
  CHECK(difference(floats[0], floats[1], CV_32F) == expected);
}

}  // namespace

TEST_CASE("the cost of an overlap is the sum of squares at every depth") {
  for (const std::uint32_t count : {1U, 3U, 100U, 40000U}) check_depths(count);
}
