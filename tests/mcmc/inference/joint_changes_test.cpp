// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/joint_changes.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using mcmc::ChangePair;

namespace {

/// Sums over all ways in which the changes may have happened. Of two that happen together the first is
/// excluded, once, whichever of them a pair names.
std::vector<double> enumerated(const std::vector<double>& p, const std::vector<ChangePair>& together,
                               const std::vector<ChangePair>& exclusive) {
  std::vector<std::size_t> first(p.size());
  std::iota(first.begin(), first.end(), std::size_t{0});
  for (const auto& pair : together) first[pair.b] = pair.a;
  std::set<std::pair<std::size_t, std::size_t>> rivals;
  for (const auto& pair : exclusive) rivals.insert(std::minmax(first[pair.a], first[pair.b]));
  std::vector<double> with(p.size(), 0.0);
  double all = 0;
  for (std::uint32_t state = 0; state < (1U << p.size()); ++state) {
    const auto happens = [&](std::size_t k) { return (state >> k & 1U) != 0; };
    double weight = 1;
    for (std::size_t k = 0; k < p.size(); ++k) weight *= happens(k) ? p[k] : 1 - p[k];
    for (const auto& pair : together)
      if (happens(pair.a) != happens(pair.b)) weight = 0;
    for (const auto& [one, other] : rivals)
      if (one != other && happens(one) && happens(other)) weight *= mcmc::kBothExclusive;
    all += weight;
    for (std::size_t k = 0; k < p.size(); ++k)
      if (happens(k)) with[k] += weight;
  }
  for (double& sum : with) sum /= all;
  return with;
}

std::vector<double> random_probabilities(core::Rng& rng, std::size_t count) {
  std::vector<double> p(count);
  for (double& one : p) one = 0.02 + 0.96 * rng.uniform();
  return p;
}

void check_equal(const std::vector<double>& found, const std::vector<double>& wanted, double within) {
  REQUIRE(found.size() == wanted.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    INFO(k);
    CHECK_THAT(found[k], WithinAbs(wanted[k], within));
  }
}

}  // namespace

TEST_CASE("Changes that do not bear on each other keep their probabilities") {
  const std::vector<double> p{0, 0.25, 0.5, 1};
  check_equal(mcmc::joint_probabilities(p, {}, {}), p, 1e-9);
  CHECK(mcmc::joint_probabilities({}, {}, {}).empty());
}

TEST_CASE("Changes that happen together have one probability") {
  const std::vector<double> p{0.9, 0.2, 0.7};
  const std::vector<ChangePair> together{{0, 1}};
  const auto found = mcmc::joint_probabilities(p, together, {});
  CHECK_THAT(found[0], WithinAbs(0.9 * 0.2 / (0.9 * 0.2 + 0.1 * 0.8), 1e-9));
  CHECK(found[1] == found[0]);
  CHECK_THAT(found[2], WithinAbs(0.7, 1e-9));
  // One of them certain, the other impossible: neither is believed more than the other.
  const std::vector<double> sure{1, 0};
  CHECK_THAT(mcmc::joint_probabilities(sure, together, {})[0], WithinAbs(0.5, 1e-4));
}

TEST_CASE("Joint probabilities are those of enumeration") {
  // Up to 10 changes, of which few exclude each other, so that no walk is cut short.
  core::Rng rng(7);
  for (int round = 0; round < 300; ++round) {
    CAPTURE(round);
    const auto count = 2 + static_cast<std::size_t>(9 * rng.uniform());
    const auto p = random_probabilities(rng, count);
    std::vector<ChangePair> together, exclusive;
    for (std::size_t k = 0; k + 1 < count; k += 2)
      if (rng.uniform() < 0.4) together.push_back({k, k + 1});
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = a + 1; b < count; ++b)
        if (rng.uniform() < 1.2 / static_cast<double>(count)) exclusive.push_back({a, b});
    // Odds under 1/1000 exclude nothing, which two that happen together may have.
    check_equal(mcmc::joint_probabilities(p, together, exclusive), enumerated(p, together, exclusive),
                together.empty() ? 1e-9 : 1e-3);
  }
}

TEST_CASE("Where many changes exclude each other the likeliest is left") {
  std::vector<double> p(40, 0.3);
  p[11] = 0.99;
  std::vector<ChangePair> exclusive;
  for (std::size_t a = 0; a < p.size(); ++a)
    for (std::size_t b = a + 1; b < p.size(); ++b) exclusive.push_back({a, b});
  const auto found = mcmc::joint_probabilities(p, {}, exclusive);
  for (std::size_t k = 0; k < p.size(); ++k) {
    CAPTURE(k);
    CHECK((k == 11 ? found[k] > 0.5 : found[k] < 0.2));
  }
}

TEST_CASE("Joint probabilities do not depend on the order of pairs") {
  core::Rng rng(9);
  const auto p = random_probabilities(rng, 12);
  std::vector<ChangePair> exclusive;
  for (std::size_t k = 0; k + 1 < p.size(); ++k) exclusive.push_back({k, k + 1});
  std::vector<ChangePair> reversed;
  for (std::size_t k = exclusive.size(); k-- > 0;) reversed.push_back({exclusive[k].b, exclusive[k].a});
  CHECK(mcmc::joint_probabilities(p, {}, exclusive) == mcmc::joint_probabilities(p, {}, reversed));
}

TEST_CASE("Joint probabilities refuse what makes no sense") {
  const std::vector<double> p{0.5, 0.5, 0.5}, none{0.5, 1.5};
  const std::vector<ChangePair> outside{{0, 3}}, itself{{1, 1}}, twice{{0, 1}, {1, 2}};
  CHECK_THROWS_AS(mcmc::joint_probabilities(none, {}, {}), core::InputError);
  CHECK_THROWS_AS(mcmc::joint_probabilities(p, outside, {}), core::InputError);
  CHECK_THROWS_AS(mcmc::joint_probabilities(p, {}, itself), core::InputError);
  CHECK_THROWS_AS(mcmc::joint_probabilities(p, twice, {}), core::InputError);
}
