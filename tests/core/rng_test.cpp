// SPDX-License-Identifier: Apache-2.0
#include "core/rng.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/statistics.hpp"

using namespace emberfold;
using namespace emberfold::test;
using core::Rng;

namespace {

constexpr double kRare = 1e-4;  // seeds are fixed: a test that passes once passes always

std::size_t bin(double share, std::size_t bins) {
  return static_cast<std::size_t>(share * static_cast<double>(bins));
}

}  // namespace

TEST_CASE("The tests' own statistics agree with printed tables", "[statistics]") {
  // Critical values of χ²: Abramowitz & Stegun, table 26.8.
  CHECK_THAT(test::gamma_q(0.5, 3.84146 / 2), WithinAbs(0.05, 1e-6));
  CHECK_THAT(test::gamma_q(5, 18.3070 / 2), WithinAbs(0.05, 1e-6));
  CHECK_THAT(test::gamma_q(5, 3.94030 / 2), WithinAbs(0.95, 1e-6));
  CHECK_THAT(test::gamma_q(50, 149.449 / 2), WithinAbs(0.001, 1e-6));
  CHECK_THAT(test::gamma_q(1, 20), WithinRel(std::exp(-20.0), 1e-12));  // two degrees: exp(−x)
  CHECK(test::gamma_q(3, 0) == 1);
  CHECK_THAT(test::normal_cdf(1.959963984540054), WithinAbs(0.975, 1e-12));
}

TEST_CASE("Philox gives the published answers", "[core][rng]") {
  using Block = std::array<std::uint32_t, 4>;
  CHECK(core::philox4x32({0, 0, 0, 0}, {0, 0}) == Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(core::philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
        Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(core::philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("A stream is Philox counting, with the seed as key and the stream's name beside the counter",
          "[core][rng]") {
  Rng rng(0x299f31d0a4093822, {0x85a308d3, 0x13198a2e, 0x03707344});
  for (std::uint32_t n = 0; n < 3; ++n)
    for (const std::uint32_t word :
         core::philox4x32({n, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}))
      CHECK(rng.bits() == word);
}

TEST_CASE("Neighbouring seeds and streams share no numbers", "[core][rng]") {
  std::set<std::uint64_t> seen;
  std::size_t drawn = 0;
  const auto draw = [&](Rng rng) {
    for (int i = 0; i < 64; ++i) {
      const std::uint64_t high = rng.bits();
      seen.insert(high << 32 | rng.bits());
      ++drawn;
    }
  };
  for (std::uint32_t i = 0; i < 20; ++i) {
    draw(Rng(i));
    draw(Rng(std::uint64_t{i + 1} << 32));
    draw(Rng(0, {i + 1, 0, 0}));
    draw(Rng(0, {0, i + 1, 0}));
    draw(Rng(0, {0, 0, i + 1}));
  }
  CHECK(seen.size() == drawn);  // 6400 draws of 64 bits: two alike once in 10^12 trials
}

TEST_CASE("Neighbouring streams are independent", "[core][rng]") {
  const auto pairs_p = [](auto make) {
    std::vector<std::size_t> counted(100);
    for (std::uint32_t i = 0; i < 50000; ++i) {
      Rng one = make(i), next = make(i + 1);
      ++counted[10 * bin(one.uniform(), 10) + bin(next.uniform(), 10)];
    }
    return uniform_p(counted);
  };
  CHECK(pairs_p([](std::uint32_t i) { return Rng(i); }) > kRare);
  CHECK(pairs_p([](std::uint32_t i) { return Rng(1, {i, 0, 0}); }) > kRare);
  CHECK(pairs_p([](std::uint32_t i) { return Rng(1, {0, i, 0}); }) > kRare);
  CHECK(pairs_p([](std::uint32_t i) { return Rng(1, {0, 0, i}); }) > kRare);
}

TEST_CASE("uniform is uniform below 1, also from draw to draw", "[core][rng]") {
  Rng rng(2);
  std::vector<std::size_t> counted(100), low_bits(64), pairs(400), triples(512);
  double before = rng.uniform(), before_that = rng.uniform();
  bool inside = true, on_grid = true;
  for (int i = 0; i < 1000000; ++i) {
    const double u = rng.uniform();
    inside = inside && u >= 0 && u < 1;
    const double scaled = u * 0x1p53;
    on_grid = on_grid && scaled == std::floor(scaled);
    ++counted[bin(u, 100)];
    ++low_bits[static_cast<std::uint64_t>(scaled) % 64];
    ++pairs[20 * bin(before, 20) + bin(u, 20)];
    ++triples[64 * bin(before_that, 8) + 8 * bin(before, 8) + bin(u, 8)];
    before_that = before;
    before = u;
  }
  CHECK(inside);
  CHECK(on_grid);
  CHECK(uniform_p(counted) > kRare);
  CHECK(uniform_p(low_bits) > kRare);
  CHECK(uniform_p(pairs) > kRare);
  CHECK(uniform_p(triples) > kRare);
}

TEST_CASE("uniform(low, high) keeps to its range", "[core][rng]") {
  Rng rng(3);
  std::vector<std::size_t> counted(50);
  for (int i = 0; i < 100000; ++i) {
    const double u = rng.uniform(-3, 7);
    REQUIRE((u >= -3 && u < 7));
    ++counted[bin((u + 3) / 10, 50)];
  }
  CHECK(uniform_p(counted) > kRare);
}

TEST_CASE("normal follows the normal distribution", "[core][rng]") {
  Rng rng(4);
  constexpr int kDraws = 1000000, kEdges = 33;  // edges at −4, −3.75, … 4
  std::vector<std::size_t> counted(kEdges + 1), joint(64);
  double sum[5] = {};
  double before = rng.normal();
  for (int i = 0; i < kDraws; ++i) {
    const double x = rng.normal();
    const double place = std::floor((x + 4) * 4) + 1;
    ++counted[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kEdges)))];
    ++joint[8 * bin(test::normal_cdf(before), 8) + bin(test::normal_cdf(x), 8)];
    before = x;
    for (int power = 1; power <= 4; ++power) sum[power] += std::pow(x, power);
  }
  std::vector<double> expected;
  double below = 0;
  for (int i = 0; i <= kEdges; ++i) {
    const double up_to = i == kEdges ? 1 : test::normal_cdf(-4 + 0.25 * i);
    expected.push_back(kDraws * (up_to - below));
    below = up_to;
  }
  CHECK(chi_squared_p(expected, counted) > kRare);
  CHECK(uniform_p(joint) > kRare);  // both halves of a Box–Muller pair, and neighbours of different pairs
  // Moments 0, 1, 0, 3 within 4 of their standard errors √(var x^k / n), var = 1, 2, 15, 96.
  const double moment[5] = {1, 0, 1, 0, 3}, variance[5] = {0, 1, 2, 15, 96};
  for (int power = 1; power <= 4; ++power) {
    CAPTURE(power);
    CHECK(std::abs(sum[power] / kDraws - moment[power]) < 4 * std::sqrt(variance[power] / kDraws));
  }
}

TEST_CASE("below is uniform and without bias", "[core][rng]") {
  Rng rng(5);
  for (const std::uint32_t count : {2U, 3U, 7U, 100U}) {
    std::vector<std::size_t> counted(count);
    for (int i = 0; i < 200000; ++i) ++counted.at(rng.below(count));
    CAPTURE(count);
    CHECK(uniform_p(counted) > kRare);
  }
  // With 3 · 2^30 values a plain multiplication would hit every third one twice as often as the others, a
  // plain remainder the lowest third.
  constexpr std::uint32_t kCount = 3U << 30;
  std::vector<std::size_t> remainder(3), third(3);
  for (int i = 0; i < 300000; ++i) {
    const std::uint32_t value = rng.below(kCount);
    REQUIRE(value < kCount);
    ++remainder[value % 3];
    ++third[value >> 30];
  }
  CHECK(uniform_p(remainder) > kRare);
  CHECK(uniform_p(third) > kRare);
  for (int i = 0; i < 100; ++i) CHECK(rng.below(1) == 0);
  CHECK_THROWS_AS(rng.below(0), core::InputError);
}

TEST_CASE("categorical draws by weight and never what weighs nothing", "[core][rng]") {
  Rng rng(6);
  const std::vector<double> weights{0, 0.5, 3, 0, 1e-2, 7.25, 0.24, 0};
  constexpr int kDraws = 500000;
  std::vector<std::size_t> counted(weights.size());
  for (int i = 0; i < kDraws; ++i) ++counted.at(rng.categorical(weights));
  std::vector<double> expected;
  std::vector<std::size_t> possible;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) {
      CHECK(counted[i] == 0);
      continue;
    }
    expected.push_back(kDraws * weights[i] / 11.0);
    possible.push_back(counted[i]);
  }
  CHECK(chi_squared_p(expected, possible) > kRare);

  const std::vector<double> only{0, 0, 1e-300, 0}, huge{1e307, 3e307};
  std::vector<std::size_t> of_huge(2);
  for (int i = 0; i < 20000; ++i) {
    REQUIRE(rng.categorical(only) == 2);
    ++of_huge[rng.categorical(huge)];
  }
  CHECK(chi_squared_p({5000, 15000}, of_huge) > kRare);
}

TEST_CASE("categorical refuses weights that are none", "[core][rng]") {
  Rng rng(7);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::vector<double>> bad{{},    {0},      {0, 0},   {1, -1e-9},
                                             {nan}, {1, nan}, {1, inf}, {1e308, 1e308}};
  for (const std::vector<double>& weights : bad) {
    CAPTURE(weights);
    CHECK_THROWS_AS(rng.categorical(weights), core::InputError);
  }
  try {
    rng.categorical(std::vector<double>{1, -2});
    FAIL("a negative weight passed");
  } catch (const core::InputError& error) {
    CHECK(std::string(error.what()).find("-2") != std::string::npos);
  }
}

TEST_CASE("A copy goes on from the same place", "[core][rng]") {
  // After each number of draws: inside a block of four words, and between the two normals of a pair.
  for (int drawn = 0; drawn < 9; ++drawn)
    for (int normals = 0; normals < 2; ++normals) {
      Rng rng(8, {1, 2, 3});
      for (int i = 0; i < drawn; ++i) rng.bits();
      for (int i = 0; i < normals; ++i) rng.normal();
      Rng copy = rng;
      for (int i = 0; i < 10; ++i) {
        CAPTURE(drawn, normals, i);
        CHECK(copy.normal() == rng.normal());
        CHECK(copy.bits() == rng.bits());
        CHECK(copy.uniform() == rng.uniform());
      }
    }
}
