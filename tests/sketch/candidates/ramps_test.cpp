// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/ramps.hpp"

#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using sketch::RampSums;

TEST_CASE("A ramp's residual is that of an ordinary least-squares line") {
  RampSums sums;
  double squares = 0;
  for (int i = 0; i < 200; ++i) {
    const int pair = i / 2;  // of noise that cancels
    const double across = pair - 50;
    const double noise = i % 2 == 0 ? 1.5 : -1.5;
    sums.add(7 + 0.3 * across + noise, across);
    squares += noise * noise;
  }
  CHECK_THAT(sums.residual(), WithinRel(squares, 1e-9));
  RampSums parts, other;
  parts.add(1, 0), parts.add(4, 1), other.add(5, 2), other.add(0, 3);
  parts.add(other);
  CHECK(parts.n == 4);
  CHECK_THAT(parts.residual(),
             WithinAbs(16.8, 1e-9));  // of 1, 4, 5, 0 about their mean 2.5: the slope is −0.2
}

TEST_CASE("Ramps end where others explain the most pixels of a bin") {
  sketch::Ramps ramps;
  ramps.reset(5);
  const auto fill = [&](double left, double right) {
    for (int i = 0; i < 4; ++i)
      for (const int bin : {0, 1, 3, 4}) ramps.add(bin, bin < 2 ? left : right, bin - 2.0);
  };
  fill(10, 90);
  const double one = ramps.residual();  // a ramp through both levels
  CHECK(one > 1000);
  for (int i = 0; i < 4; ++i) ramps.add_other(2);
  CHECK_THAT(ramps.residual(), WithinAbs(0, 1e-9));  // a level on each side
  ramps.reset(5);
  fill(10, 90);
  CHECK_THAT(ramps.residual(), WithinRel(one, 1e-12));
}
