// SPDX-License-Identifier: Apache-2.0
// The chain itself against laws that are known: of a few candidates all states can be counted, and sways have
// a Gaussian whose precision is the density's curvature.
#include <cmath>
#include <map>

#include <Eigen/LU>

#include "mcmc/sampler/chain.hpp"
#include "mcmc/sampler/displacement_gibbs.hpp"
#include "tests/mcmc/sampler/free_chain.hpp"
#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kFrames = 3;

/// A candidate in each frame, each of which may continue the one before; and whose being on, and linked, is
/// neither sure nor rare.
HiddenGraph one_a_frame() {
  HiddenGraph g(60, 40, kFrames, {12, 20, 0});
  for (int t = 0; t < kFrames; ++t) g.add_candidate(t, patch(15 + 13 * t, 20 + 0.5 * t));
  const std::array evidence{11.5, 12.0, 10.7};
  for (Index i = 0; i < g.size(); ++i) g.set_evidence(i, evidence[i]);
  return g;
}

/// Which candidates are on, and after them which are linked with the next.
int key_of(const HiddenGraph& g) {
  int key = 0;
  for (Index i = 0; i < kFrames; ++i)
    key |= (g[i].active ? 1 : 0) << i | (g[i].next.empty() ? 0 : 1) << (kFrames + i);
  return key;
}

/// The state of that key; none where a link has no ends.
std::optional<HiddenGraph> state_of(int key) {
  HiddenGraph g = one_a_frame();
  for (Index i = 0; i < kFrames; ++i)
    if ((key >> i & 1) != 0) g.activate(i);
  for (Index i = 0; i + 1 < kFrames; ++i)
    if ((key >> (kFrames + i) & 1) != 0) {
      if (!g.can_link(i, i + 1)) return std::nullopt;
      g.link(i, i + 1);
    }
  return g;
}

/// Log of the density's integral over all sways.
double log_weight(HiddenGraph& g, const Density& density) {
  double sum = 0;
  for (const auto& path : mcmc::find_paths(g)) {
    const auto given = mcmc::displacement_given_rest(g, density, path);
    for (std::size_t i = 0; i < path.size(); ++i) {
      g.set_displacement(path[i], given.mean[i]);
      sum += 0.5 * std::log(2 * std::numbers::pi) - std::log(given.factor[i][2]);
    }
  }
  return sum + density.total(g);
}

std::map<int, double> shares_of_states(const SamplerParameters& theta) {
  const Density density(theta);
  std::map<int, double> shares;
  double sum = 0;
  for (int key = 0; key < 1 << (2 * kFrames - 1); ++key)
    if (auto g = state_of(key)) sum += shares[key] = std::exp(log_weight(*g, density));
  for (auto& [key, share] : shares) share /= sum;
  return shares;
}

/// Precision and mean of a quadratic log density by its differences.
struct Quadratic {
  Eigen::MatrixXd precision;
  Eigen::VectorXd mean;
};
Quadratic measured(HiddenGraph& g, const Density& density, const std::vector<Index>& path) {
  const auto n = static_cast<Eigen::Index>(path.size());
  const auto value = [&](const Eigen::VectorXd& x) {
    for (Eigen::Index i = 0; i < n; ++i) g.set_displacement(path[static_cast<std::size_t>(i)], x[i]);
    return density.total(g);
  };
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(n, n);
  Quadratic found{Eigen::MatrixXd(n, n), Eigen::VectorXd(n)};
  Eigen::VectorXd slope(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    slope[i] = (value(unit.col(i)) - value(-unit.col(i))) / 2;
    for (Eigen::Index j = 0; j < n; ++j)
      found.precision(i, j) = -(value(unit.col(i) + unit.col(j)) - value(unit.col(i) - unit.col(j)) -
                                value(unit.col(j) - unit.col(i)) + value(-unit.col(i) - unit.col(j))) /
                              4;
  }
  found.mean = found.precision.inverse() * slope;
  return found;
}

}  // namespace

TEST_CASE("A chain is in each state as often as the density says", "[mcmc][chain]") {
  const auto theta = even_theta();
  const auto shares = shares_of_states(theta);
  REQUIRE(shares.size() == 13);  // by on and off: 4 of all three, 2, 2 and 1 of two, 3 of one, 1 of none
  mcmc::Chain chain(one_a_frame(), theta, 17, 0);
  std::map<int, std::vector<double>> seen;
  for (int n = 0; n < 20000; ++n) {
    chain.sweep(4, {});
    const int now = key_of(chain.state());
    REQUIRE(shares.contains(now));
    for (const auto& [key, share] : shares) seen[key].push_back(key == now ? 1 : 0);
  }
  for (const auto& [key, share] : shares) {
    const Mean mean = mean_of_chain(seen[key]);
    INFO("state " << key << ": " << mean.value << " +- " << mean.error << ", expected " << share);
    CHECK(share > 0.01);
    CHECK(std::abs(z_score(mean, {share, 0})) < 4.5);
  }
}

TEST_CASE("Sways that are drawn have the spread and the correlation of their law", "[mcmc][chain]") {
  HiddenGraph g(60, 40, 4, {12, 12, 0});
  for (int t = 0; t < 4; ++t) shown(g, t, patch(25 + t, 20 + 0.5 * t));
  for (Index i = 0; i + 1 < 4; ++i) g.link(i, i + 1);
  const Density density(even_theta());
  const auto path = mcmc::find_paths(g).at(0);
  REQUIRE(path.size() == 4);
  const Quadratic law = measured(g, density, path);
  const Eigen::MatrixXd covariance = law.precision.inverse();
  constexpr int draws = 20000;
  mcmc::RandomChoices choices(core::Rng(3, {1, 0, 0}));
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(4, 4);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(4), x(4);
  for (int n = 0; n < draws; ++n) {
    mcmc::draw_displacements(g, density, path, choices);
    for (Eigen::Index i = 0; i < 4; ++i)
      x[i] = g[path[static_cast<std::size_t>(i)]].displacement - law.mean[i];
    sum += x, sums += x * x.transpose();
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    CHECK(std::abs(sum[i] / draws) < 4.5 * std::sqrt(covariance(i, i) / draws));
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double error =
          std::sqrt((covariance(i, i) * covariance(j, j) + covariance(i, j) * covariance(i, j)) / draws);
      CHECK_THAT(sums(i, j) / draws, WithinAbs(covariance(i, j), 4.5 * error));
    }
  }
}
