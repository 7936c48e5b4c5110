// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_labelling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using pipeline::Labelling;

namespace {

double energy(const Labelling& of, const std::vector<char>& labels) {
  double sum = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) sum -= labels[i] != 0 ? of.gain[i] : 0;
  for (const auto& star : of.stars) {
    const auto on = std::ranges::count_if(star.parts, [&](std::size_t i) { return labels[i] != 0; });
    sum += of.change * std::abs(double(on) - labels[star.whole]);
  }
  return sum;
}

double least_energy(const Labelling& of) {
  double least = std::numeric_limits<double>::max();
  for (std::uint32_t set = 0; set < 1U << of.gain.size(); ++set) {
    std::vector<char> labels;
    for (std::size_t i = 0; i < of.gain.size(); ++i) labels.push_back((set >> i & 1U) != 0 ? 1 : 0);
    least = std::min(least, energy(of, labels));
  }
  return least;
}

/// Ten units of random gains and six stars of `parts` parts.
Labelling random_labelling(core::Rng& rng, std::size_t parts) {
  Labelling of;
  for (int i = 0; i < 10; ++i) of.gain.push_back(rng.uniform(-30, 30));
  of.change = 12;
  for (int n = 0; n < 6; ++n) {
    std::vector<std::size_t> units(10);
    std::iota(units.begin(), units.end(), std::size_t{0});
    for (std::uint32_t k = 0; k < 9; ++k) std::swap(units[k], units[k + rng.below(10 - k)]);
    of.stars.push_back(
        {units[0], {units.begin() + 1, units.begin() + 1 + static_cast<std::ptrdiff_t>(parts)}});
  }
  return of;
}

}  // namespace

TEST_CASE("labels have the least energy of all where a star has one part") {
  core::Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const auto of = random_labelling(rng, 1);
    CHECK(std::abs(energy(of, best_labels(of)) - least_energy(of)) < 1e-9);
  }
}

TEST_CASE("with larger stars no single change of a label lowers the energy, which is mostly the least") {
  core::Rng rng(2);
  int best = 0;
  for (int i = 0; i < 200; ++i) {
    const auto of = random_labelling(rng, 2);
    auto labels = best_labels(of);
    const double found = energy(of, labels);
    best += found < least_energy(of) + 1e-9 ? 1 : 0;
    for (char& label : labels) {
      const char kept = std::exchange(label, label == 0 ? char{1} : char{0});
      CHECK(energy(of, labels) > found - 1e-6);
      label = kept;
    }
  }
  CHECK(best > 110);
}

TEST_CASE("a split costs as many changes as it has parts more than one") {
  // The whole and one part gain enough; the other part gains less than a change costs.
  Labelling of{.gain = {20, 20, 5}, .change = 12, .stars = {{0, {1, 2}}}};
  CHECK(best_labels(of) == std::vector<char>{1, 1, 0});
  of.gain[2] = 13;
  CHECK(best_labels(of) == std::vector<char>{1, 1, 1});
  // Without its whole a part is a birth.
  of.gain = {-20, 11, -5};
  CHECK(best_labels(of) == std::vector<char>{0, 0, 0});
  of.gain[1] = 13;
  CHECK(best_labels(of) == std::vector<char>{0, 1, 0});
  CHECK(best_labels(Labelling{}).empty());
}
