// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/sample_changes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "mcmc/sampler/change_rates.hpp"
#include "mcmc/sampler/diagnostics.hpp"
#include "tests/mcmc/sampler/change_fields.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::EventType;
using mcmc::ChangeField;
using mcmc::detail::ChangeRates;
using test::WithinAbs;

namespace {

double logistic(double x) {
  return 1 / (1 + std::exp(-x));
}
double logit(double p) {
  return std::log(p) - std::log1p(-p);
}

// Unions of strokes that come in and go out: they know nothing of each other but their share.
ChangeField apart(const std::vector<double>& log_odds) {
  ChangeField field;
  for (const double odds : log_odds) {
    const auto first = static_cast<std::uint32_t>(field.strands.size());
    field.strands.push_back({0, 9, true, false, 50, 0});
    field.strands.push_back({0, 9, true, false, 50, 0});
    field.strands.push_back({10, 19, false, true, 100, 0});
    field.changes.push_back({EventType::merge, 10, {}, odds, true, {first, first + 1}, {first + 2}});
  }
  return field;
}

}  // namespace

TEST_CASE("The share of true changes is learned from those near a place", "[changes]") {
  double last = 0;
  for (const double share : {0.02, 0.2, 0.5, 0.9}) {
    std::vector<double> images(2000);
    for (std::size_t i = 0; i < images.size(); ++i)
      images[i] = static_cast<double>(i) < 2000 * share ? 6 : -6;
    const ChangeField field = apart(images);
    ChangeRates rates(field);
    rates.learn_alone();
    const double shift = rates.log_odds()[0] - images[0];
    const double found = logistic(shift + logit(mcmc::detail::kUsualShare));
    INFO("share " << share << ", found " << found);
    // It is where a mixture of true and false changes is most likely, under Beta(3/2, 3/2).
    const auto log_likelihood = [&](double s) {
      double sum = 0.5 * (std::log(s) + std::log1p(-s));
      for (const double odds : images)
        sum += std::log(s * std::exp(odds - logit(mcmc::detail::kUsualShare)) + 1 - s);
      return sum;
    };
    for (const double beside : {0.7, 0.95, 1.05, 1.3}) {
      const double odds = beside * found / (1 - found);
      CHECK(log_likelihood(odds / (1 + odds)) < log_likelihood(found));
    }
    CHECK(found > last);
    last = found;
    for (std::size_t i = 0; i < images.size(); i += 200)
      CHECK_THAT(rates.log_odds()[i], WithinAbs(images[i] + shift, 1e-9));
  }
}

TEST_CASE("Half of a true and of a false change are counted beforehand", "[changes]") {
  const ChangeField field = apart({1, 1, -2});
  ChangeRates rates(field);
  rates.learn(std::vector<double>{1, 0.5, 0});
  const double shift = logit((0.5 + 1.5) / 4) - logit(mcmc::detail::kUsualShare);
  CHECK_THAT(rates.log_odds()[0], WithinAbs(1 + shift, 1e-12));
  CHECK_THAT(rates.log_odds()[2], WithinAbs(-2 + shift, 1e-12));
}

TEST_CASE("What happens in one place says nothing about a change far away", "[changes]") {
  std::vector<double> images(21, -6);
  images[0] = 2;  // one that shows well, and others that do not
  const auto with_others_at = [&](double x) {
    ChangeField field = apart(images);
    for (std::size_t k = 1; k < field.changes.size(); ++k) field.changes[k].place = {x, 0};
    ChangeRates rates(field);
    rates.learn_alone();
    return rates.log_odds()[0];
  };
  CHECK(with_others_at(0) < with_others_at(120) - 0.1);
  CHECK(with_others_at(120) < with_others_at(240) - 0.1);
  ChangeField alone = apart({images[0]});
  ChangeRates rates(alone);
  rates.learn_alone();
  CHECK(with_others_at(mcmc::detail::kRateReach + 32) == rates.log_odds()[0]);
  // What has no rate neither counts nor is changed.
  ChangeField field = apart({2, -6, -6});
  field.changes[1].has_rate = field.changes[2].has_rate = false;
  ChangeRates of_one(field);
  of_one.learn_alone();
  CHECK(of_one.log_odds() == std::vector<double>{rates.log_odds()[0], -6, -6});
}

TEST_CASE("Strokes that last a short time say nothing about others, and others nothing about them",
          "[changes]") {
  const auto rates_of = [](const ChangeField& field) {
    ChangeRates rates(field);
    rates.learn_alone();
    return rates.log_odds();
  };
  const auto with_births_of = [&](int frames) {
    ChangeField field = apart({2, 1});
    for (int k = 0; k < 5; ++k) {
      field.strands.push_back({5, 5 + frames - 1, false, false, 9, 0});
      const auto stroke = static_cast<std::uint32_t>(field.strands.size() - 1);
      field.changes.push_back({EventType::birth, 5, {}, -6, true, {}, {stroke}});
    }
    return rates_of(field);
  };
  const auto alone = rates_of(apart({2, 1}));
  CHECK(with_births_of(4)[0] < alone[0]);
  CHECK(with_births_of(3)[0] == alone[0]);
  CHECK(with_births_of(3)[2] < with_births_of(4)[2]);
}

TEST_CASE("Changes that know nothing of each other have the probability of their odds", "[changes]") {
  std::vector<double> images;
  for (int k = 0; k < 60; ++k) images.push_back(-5 + k / 6.0);
  const ChangeField field = apart(images);
  ChangeRates rates(field);
  rates.learn_alone();
  const auto sampled = mcmc::sample_changes(field, 1);
  for (std::size_t k = 0; k < images.size(); ++k) {
    const double p = logistic(rates.log_odds()[k]);
    CHECK_THAT(sampled.probabilities[k], WithinAbs(p, 0.03 + 4 * std::sqrt(p * (1 - p) / 800)));
  }
  REQUIRE(sampled.run.chains == 4);
  for (const auto& trace : sampled.run.traces) {
    REQUIRE(trace.chains.size() == 4);
    std::vector<std::vector<double>> kept;
    for (const auto& chain : trace.chains) {
      REQUIRE(chain.size() == 260);
      kept.emplace_back(chain.begin() + sampled.run.burn_in, chain.end());
    }
    if (trace.name == "merges") {
      CHECK(mcmc::diagnose(kept).rhat < 1.03);
      CHECK(mcmc::diagnose(kept).bulk_ess > 400);
    }
  }
}

TEST_CASE("One end of a stroke that shows well makes the other one likelier", "[changes]") {
  const auto with = [](double birth, double death) {
    const ChangeField field = {
        {{5, 14, false, false, 50, 0}},
        {{EventType::birth, 5, {}, birth, false, {}, {0}}, {EventType::death, 15, {}, death, false, {0}, {}}},
        {}};
    return mcmc::sample_changes(field, 1).probabilities;
  };
  // Each state's weight, by hand; one violation costs 2 nats.
  for (const auto& [birth, death] : {std::pair{3.0, -1.0}, {-1.0, 3.0}, {1.0, 1.0}, {-2.0, 0.5}}) {
    const double both = std::exp(birth + death), first = std::exp(birth - 2), second = std::exp(death - 2);
    const double sum = 1 + both + first + second;
    const auto p = with(birth, death);
    CHECK_THAT(p[0], WithinAbs((both + first) / sum, 0.06));
    CHECK_THAT(p[1], WithinAbs((both + second) / sum, 0.06));
  }
}

TEST_CASE("A clip played backwards is sampled alike, and threads change nothing", "[changes]") {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ChangeField field = test::random_field(seed, 40, 3);
    const auto forwards = mcmc::sample_changes(field, 5).probabilities;
    CHECK(mcmc::sample_changes(test::reversed(field, 41), 5).probabilities == forwards);
    CHECK(mcmc::sample_changes(field, 6).probabilities != forwards);
    const core::ThreadLimit one(1);
    CHECK(mcmc::sample_changes(field, 5).probabilities == forwards);
  }
}

TEST_CASE("A field without changes has none, and one that makes no sense is refused", "[changes]") {
  CHECK(mcmc::sample_changes({}, 1).probabilities.empty());
  const auto refused = [](const auto& spoil) {
    ChangeField field = test::random_field(1, 12);
    spoil(field);
    CHECK_THROWS_AS(field.validate(), core::InputError);
  };
  test::random_field(1, 12).validate();
  refused([](ChangeField& f) { f.changes[3].after.push_back(0), f.changes[3].before.push_back(0); });
  refused([](ChangeField& f) { f.changes[0].log_odds = std::nan(""); });
  refused([](ChangeField& f) { f.strands.resize(1); });
  refused([](ChangeField& f) { f.gaps.push_back({40, 41}); });
  refused([](ChangeField& f) {
    f.changes[0].type = EventType::birth, f.changes[0].before = {0}, f.changes[0].after = {};
  });
}
