// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/chain.hpp"

#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/sampler/displacement_gibbs.hpp"
#include "mcmc/sampler/infer.hpp"
#include "mcmc/sampler/sufficient_statistics.hpp"
#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_scene.hpp"

namespace {

using namespace emberfold;
using namespace emberfold::test;

HiddenGraph drawn(const mcmc::SamplerParameters& theta, int side, int frames, std::uint32_t number) {
  core::Rng rng(11, {number, 0, 0});
  return mcmc::simulate_prior(theta, side, side, frames, test::kLivelyGates, rng);
}

/// A θ under which strokes live long and move much, so that it can be learned from them.
mcmc::SamplerParameters lasting_theta() {
  auto theta = test::lively_theta();
  for (auto& chances : theta.outcome) chances = {0.04, 0.94, 0.01, 0.01};
  theta.displacement = {1.5, -0.8, 0.1, 0.4, 0, 0};
  theta.across = 0.2;
  theta.birth = {0.0012, 0.0001};
  theta.growth = {0.02, 0.01, 0.01, 0.6};
  theta.first_growth = 0.8;
  return theta;
}

std::vector<graph::MotionGraph> swaying_starts() {
  test::Scene scene;
  scene.strokes = test::scattered(3, 3, 160, 120, 30);
  scene.width = 160, scene.height = 120, scene.frames = 14;
  scene.displacement = {1.5, -0.8, 0.3, 30};
  auto motion = test::make(scene, 5).motion;
  return {motion, motion};
}

/// Images that show every candidate.
class AllShown final : public mcmc::Evidence {
 public:
  [[nodiscard]] double gain(int /*frame*/, const graph::Patch& /*patch*/) const override { return 100; }
};

/// How strokes grow, close up and look where they begin, as the truth has it: |z| < 4.5.
void check_growth(const mcmc::SufficientStatistics& mean, const mcmc::SamplerParameters& found,
                  const mcmc::SamplerParameters& truth, double clips) {
  const auto check_rate = [&](const char* name, double estimate, double rate, double exposure) {
    INFO(name << ": " << estimate << ", true " << rate << ", exposure " << exposure * clips);
    REQUIRE(exposure * clips * rate > 20);
    CHECK(std::abs(estimate - rate) < 4.5 * std::sqrt(rate / (exposure * clips)));
  };
  check_rate("growth of ends", found.growth[0], truth.growth[0], mean.parents[0]);
  check_rate("growth inside", found.growth[1], truth.growth[1], mean.parents[1]);
  check_rate("growth of what is new", found.growth[3], truth.growth[3], mean.parents[3] / 2);
  check_rate("growth in frame 0", found.first_growth, truth.first_growth, mean.first_parents / 2);
  for (const std::size_t epoch : {0, 1}) {
    double joined = 0, expected = 0, variance = 0;
    for (std::size_t k = 0; k < mcmc::kCloseness; ++k) {
      const auto& pair = mean.close[epoch][k];
      const double p = truth.close[epoch][k];
      joined += pair.joined, expected += pair.exposure * p, variance += pair.exposure * p * (1 - p);
    }
    INFO("closing in epoch " << epoch << ": " << joined * clips << ", expected " << expected * clips);
    CHECK(std::abs(joined - expected) < 4.5 * std::sqrt(variance / clips));
  }
  const double begun = (mean.begun[0] + mean.begun[1]) * clips;
  CHECK_THAT(found.new_contrast,
             WithinAbs(truth.new_contrast, 4.5 * truth.new_contrast_sd / std::sqrt(begun)));
  CHECK_THAT(found.new_contrast_sd, WithinRel(truth.new_contrast_sd, 4.5 / std::sqrt(2 * begun)));
}

}  // namespace

TEST_CASE("Sways of a course have the Gaussian that the density gives them", "[mcmc][chain]") {
  auto theta = test::lively_theta();
  theta.displacement.coupling = 0.2;
  const mcmc::Density density(theta);
  for (std::uint32_t number = 0; number < 10; ++number) {
    auto g = drawn(theta, 40, 5, number);
    for (const auto& course : mcmc::find_paths(g)) {
      const auto given = mcmc::displacement_given_rest(g, density, course);
      const std::size_t n = course.size();
      for (std::size_t i = 0; i < n; ++i) g.set_displacement(course[i], given.mean[i]);
      const double top = density.total(g);
      for (std::size_t i = 0; i < n; ++i) {
        // A quadratic: its second differences are exact, and are the precision L Lᵀ.
        const double step = 0.5;
        g.set_displacement(course[i], given.mean[i] + step);
        const double up = density.total(g);
        g.set_displacement(course[i], given.mean[i] - step);
        const double down = density.total(g);
        g.set_displacement(course[i], given.mean[i]);
        double precision = 0;
        for (const double l : given.factor[i]) precision += l * l;
        CHECK_THAT(up, WithinAbs(down, 1e-6));
        CHECK_THAT(2 * top - up - down, WithinRel(precision * step * step, 1e-6));
      }
    }
  }
}

TEST_CASE("Every node that is on lies in one course", "[mcmc][chain]") {
  const auto g = drawn(test::lively_theta(), 50, 6, 3);
  std::vector<int> seen(g.size());
  for (const auto& course : mcmc::find_paths(g))
    for (std::size_t k = 0; k < course.size(); ++k) {
      ++seen[course[k]];
      CHECK(g[course[k]].frame == g[course[0]].frame + static_cast<int>(k));
    }
  for (Index i = 0; i < g.size(); ++i) CHECK(seen[i] == (g[i].active ? 1 : 0));
}

TEST_CASE("A chain keeps its density by the moves' gains, whatever the threads", "[mcmc][chain]") {
  const auto theta = test::lively_theta();
  const auto start = drawn(theta, 60, 14, 7);
  std::array<std::uint64_t, 3> hashes{};
  for (std::size_t k = 0; k < hashes.size(); ++k) {
    const core::ThreadLimit limit(std::array<std::size_t, 3>{1, 2, 8}[k]);
    mcmc::Chain chain(start, theta, 3, 0);
    for (int n = 0; n < 10; ++n) {
      chain.log_density();  // from here on it is kept up
      chain.move(20, {});
      const double whole = mcmc::Density(theta).total(chain.state());
      CHECK_THAT(chain.log_density(), WithinAbs(whole, 1e-9 * (1 + std::abs(whole))));
      chain.redraw_displacements();
    }
    hashes[k] = chain.state().hash();
  }
  CHECK(hashes[0] == hashes[1]);
  CHECK(hashes[0] == hashes[2]);
  mcmc::Chain other(start, theta, 4, 0);
  for (int n = 0; n < 10; ++n) other.sweep(20, {});
  CHECK(other.state().hash() != hashes[0]);
}

TEST_CASE("Theta is learned from what was drawn by it", "[mcmc][chain]") {
  const auto truth = lasting_theta();
  auto prior = truth;
  prior.displacement = {1.0, -0.3, 0, 0.5, 0, 0};
  mcmc::SufficientStatistics sums;
  const int clips = 40;
  const double area = 80 * 80;
  for (std::uint32_t n = 0; n < clips; ++n) {
    auto g = drawn(truth, 80, 24, n);
    sums.blend(mcmc::sufficient_statistics(g, mcmc::Density(truth)), 1.0 / (n + 1));
  }
  const auto found = mcmc::most_likely_parameters(sums, prior, area);
  CHECK_THAT(found.displacement.a1, WithinRel(truth.displacement.a1, 0.05));
  CHECK_THAT(found.displacement.a2, WithinRel(truth.displacement.a2, 0.05));
  CHECK_THAT(found.displacement.coupling, WithinAbs(truth.displacement.coupling, 0.03));
  CHECK_THAT(found.displacement.noise, WithinRel(truth.displacement.noise, 0.05));
  CHECK_THAT(found.across, WithinRel(truth.across, 0.05));
  CHECK_THAT(found.along, WithinRel(truth.along, 0.05));
  CHECK_THAT(found.turn, WithinRel(truth.turn, 0.05));
  CHECK_THAT(found.flicker, WithinRel(truth.flicker, 0.05));
  // Rates: |z| < 4.5, from the events of all clips.
  const auto z = [&](double estimate, double rate, double occasions) {
    return (estimate - rate) / std::sqrt(rate * (1 - rate) / (occasions * clips));
  };
  for (const std::size_t c : {mcmc::outcome_context(2, false, 1), mcmc::outcome_context(1, false, 1),
                              mcmc::outcome_context(1, false, 0)}) {
    double occasions = 0;
    for (const double n : sums.outcome[c]) occasions += n;
    INFO("configuration " << c << ", occasions " << occasions);
    REQUIRE(occasions * clips > 200);
    CHECK(std::abs(z(found.outcome[c][0], truth.outcome[c][0], occasions)) < 4.5);
    CHECK(std::abs(z(found.outcome[c][2], truth.outcome[c][2], occasions)) < 4.5);
  }
  const auto& kept = sums.join[2][0];
  CHECK(std::abs(z(found.join[2][0], truth.join[2][0], kept.exposure)) < 4.5);
  CHECK_THAT(found.birth[0], WithinRel(truth.birth[0], 0.15));
  CHECK_THAT(found.birth[1], WithinRel(truth.birth[1], 0.15));
  check_growth(sums, found, truth, clips);
}

TEST_CASE("infer samples every chain and tells of it", "[mcmc][chain]") {
  const auto starts = swaying_starts();
  mcmc::FitOptions fit_options;
  fit_options.calibrate = false;
  const auto learned = mcmc::fit(starts[0], fit_options).model;
  mcmc::InferOptions options;
  options.burn_in = 4, options.sweeps = 6;
  const auto result = mcmc::infer(starts, learned, mcmc::SketchEvidence{}, options, 9);
  CHECK(result.chains == 2);
  CHECK(result.samples.size() == 10);
  for (const auto& sample : result.samples) graph::validate(sample);
  for (const auto& trace : result.traces) {
    REQUIRE(trace.chains.size() == 2);
    for (const auto& chain : trace.chains) CHECK(chain.size() == 10);
  }
  double evaluated = 0;
  for (const auto& move : result.moves) evaluated += move.evaluated;
  CHECK(evaluated == result.proposals);
  CHECK(evaluated > 1000);
  const core::ThreadLimit limit(2);
  const auto again = mcmc::infer(starts, learned, mcmc::SketchEvidence{}, options, 9);
  CHECK(again.samples == result.samples);
}

TEST_CASE("All chains have one theta, and one that starts from nothing comes to the graphs of the others",
          "[mcmc][chain]") {
  const auto starts = swaying_starts();
  const auto learned = mcmc::fit(starts[0], {9, false}).model;
  mcmc::InferOptions options;
  options.burn_in = 60, options.sweeps = 20, options.from_nothing = true;
  const auto result = mcmc::infer(starts, learned, AllShown{}, options, 9);
  REQUIRE(result.chains == 3);
  const auto trace = [&](const char* name) {
    return std::ranges::find(result.traces, name, &mcmc::Trace::name)->chains;
  };
  for (const char* name : {"a1", "a2"}) {
    CHECK(trace(name)[1] == trace(name)[0]);
    CHECK(trace(name)[2] == trace(name)[0]);
  }
  CHECK(trace("patches")[2].front() < 0.8 * trace("patches")[0].front());
  for (const char* name : {"patches", "edges", "links"}) {
    const auto mean = [&](std::size_t k) {
      const auto chain = trace(name)[k];
      return std::accumulate(chain.end() - 20, chain.end(), 0.0) / 20;
    };
    INFO(name << ": " << mean(0) << ", " << mean(1) << ", from nothing " << mean(2));
    CHECK_THAT(mean(2), WithinRel(mean(0), 0.02));
    CHECK_THAT(mean(1), WithinRel(mean(0), 0.02));
  }
}

TEST_CASE("infer learns theta from what sways, and only during burn-in", "[mcmc][chain]") {
  const auto starts = swaying_starts();
  mcmc::FitOptions fit_options;
  fit_options.calibrate = false;
  auto learned = mcmc::fit(starts[0], fit_options).model;
  learned.displacement.a1 = 0.5, learned.displacement.a2 = 0;  // the strokes have 1.5 and −0.8
  mcmc::InferOptions options;
  options.burn_in = 16, options.sweeps = 4;
  const auto result = mcmc::infer({starts.data(), 1}, learned, mcmc::SketchEvidence{}, options, 9);
  const auto a1 = std::ranges::find(result.traces, "a1", &mcmc::Trace::name);
  REQUIRE(a1 != result.traces.end());
  const auto& values = a1->chains.at(0);
  REQUIRE(values.size() == 20);
  CHECK(values[15] > 0.65);
  CHECK(values[14] != values[15]);
  for (std::size_t n = 16; n < values.size(); ++n) CHECK(values[n] == values[15]);
}

TEST_CASE("infer refuses what it cannot do", "[mcmc][chain]") {
  const auto starts = swaying_starts();
  const mcmc::MotionModel learned = mcmc::fit(starts[0], {1, false}).model;
  const mcmc::SketchEvidence evidence;
  CHECK_THROWS_AS(mcmc::infer({}, learned, evidence, {}, 1), core::InputError);
  auto other = starts;
  other[1].sketch.width = 10;
  CHECK_THROWS_AS(mcmc::infer(other, learned, evidence, {}, 1), core::InputError);
  const auto refuse = [&](auto change) {
    mcmc::InferOptions options;
    change(options);
    CHECK_THROWS_AS(options.validate(), core::InputError);
  };
  refuse([](auto& o) { o.sweeps = 0; });
  refuse([](auto& o) { o.burn_in = 0; });
}
