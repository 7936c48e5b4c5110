// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/section_choice.hpp"

#include <algorithm>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

double worth(const std::vector<double>& gain, const std::vector<char>& on, double end_cost, bool closed) {
  double sum = 0;
  for (std::size_t i = 0; i < gain.size(); ++i) {
    if (on[i] != 0) sum += gain[i];
    if (i > 0 && on[i] != on[i - 1]) sum -= end_cost;
  }
  return closed ? sum : sum - end_cost * (on.front() + on.back());
}

}  // namespace

TEST_CASE("The choice of sections is the best of all choices") {
  core::Rng rng(11);
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 1 + static_cast<std::size_t>(round) % 9;
    std::vector<double> gain(n);
    for (double& g : gain) g = 4 * rng.normal();
    for (const bool closed : {false, true}) {
      double best = -1e9;
      std::vector<char> choice;
      for (unsigned bits = 0; bits < 1U << n; ++bits) {
        std::vector<char> on(n);
        for (std::size_t i = 0; i < n; ++i) on[i] = static_cast<char>(bits >> i & 1U);
        if (worth(gain, on, 3, closed) <= best) continue;
        best = worth(gain, on, 3, closed);
        choice = on;
      }
      const bool ring = closed && std::ranges::find(choice, 0) == choice.end();
      if (ring && best <= 2 * 3) best = 0;
      CHECK_THAT(worth(gain, sketch::choose_sections(gain, 3, closed), 3, closed), WithinAbs(best, 1e-9));
    }
  }
}

TEST_CASE("A section of small loss is kept within a run, and no curve has no sections") {
  CHECK(sketch::choose_sections(std::vector<double>{20, -5, 20}, 6, false) == std::vector<char>{1, 1, 1});
  CHECK(sketch::choose_sections(std::vector<double>{20, -13, 20}, 6, false) == std::vector<char>{1, 0, 1});
  CHECK(sketch::choose_sections(std::vector<double>{11}, 6, false) == std::vector<char>{0});
  CHECK(sketch::choose_sections(std::vector<double>{11}, 6, true) == std::vector<char>{0});
  CHECK(sketch::choose_sections(std::vector<double>{13}, 6, true) == std::vector<char>{1});
  CHECK(sketch::choose_sections({}, 6, false).empty());
}
