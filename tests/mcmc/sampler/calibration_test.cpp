// SPDX-License-Identifier: Apache-2.0
// Calibration of event probabilities. Sequences are drawn forward; their patches are observed, their edges
// with noise.
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/parallel.hpp"
#include "graph/events/events.hpp"
#include "mcmc/sampler/chain.hpp"
#include "tests/mcmc/sampler/small_models.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kSide = 45, kCalibrationFrames = 4;
constexpr std::size_t kBins = 10;

/// Identity of an event. Places of a fixed set of patches are equal to the last bit, or apart.
using Key = std::tuple<int, graph::EventType, long, long>;
std::vector<Key> keys(const HiddenGraph& g) {
  std::vector<Key> result;
  for (const auto& event : graph::stroke_events(mcmc::motion_graph(g, 25)))
    result.emplace_back(event.frame, event.type, std::lround(100 * event.position.x),
                        std::lround(100 * event.position.y));
  return result;
}

/// The image's word on every pair of patches that could be joined: the log likelihood ratio of a normal
/// number about +m if they are, about −m if not.
void observe(HiddenGraph& g, core::Rng& rng) {
  constexpr double kMean = 1.2;
  for (Index i = 0; i < g.size(); ++i) {
    g.set_evidence(i, 200);  // the patches themselves are not in doubt
    std::vector<Index> near;
    for (const auto& beside : g.neighbours(i))
      if (i < beside.node) near.push_back(beside.node);
    for (const Index j : near)
      g.set_edge_evidence(i, j, 2 * kMean * ((g[i].edges.has(j) ? kMean : -kMean) + rng.normal()));
  }
}

/// All patches, nothing of what ties them.
HiddenGraph bare(HiddenGraph g) {
  for (Index i = 0; i < g.size(); ++i) {
    while (g[i].edges.size() > 0) g.remove_edge(i, *g[i].edges.begin());
    while (g[i].next.size() > 0) g.unlink(i, *g[i].next.begin());
    g.set_displacement(i, 0);
  }
  return g;
}

/// True if a patch lies where none begins: without links it would have density 0. Patches are observed, so
/// sequences may be selected by it.
bool beyond(const HiddenGraph& g) {
  for (Index i = 0; i < g.size(); ++i)
    if (!std::isfinite(g[i].log_birth)) return true;
  return false;
}

struct Said {
  double probability = 0;
  bool true_event = false;
};

/// Events of one sequence, in a sample or in the truth, with their probabilities.
std::vector<Said> judged(std::uint32_t number, int burn_in, int samples) {
  core::Rng rng(61, {number, 0, 0});
  const auto theta = test::lively_theta();
  HiddenGraph truth = mcmc::simulate_prior(theta, kSide, kSide, kCalibrationFrames, test::kLivelyGates, rng);
  if (beyond(truth)) return {};
  observe(truth, rng);
  std::map<Key, Said> all;
  for (const Key& key : keys(truth)) all[key].true_event = true;
  mcmc::Chain chain(bare(truth), theta, 62, number);
  for (int n = 0; n < burn_in; ++n) chain.sweep(8, {});
  for (int n = 0; n < samples; ++n) {
    for (int k = 0; k < 3; ++k) chain.sweep(8, {});
    for (const Key& key : keys(chain.state())) all[key].probability += 1.0 / samples;
  }
  std::vector<Said> result;
  for (const auto& [key, said] : all) result.push_back(said);
  return result;
}

}  // namespace

TEST_CASE("Events of sequences drawn forward happen as often as the sampler says",
          "[mcmc][calibration][slow]") {
  constexpr std::size_t kSequences = 600;
  std::vector<std::vector<Said>> found(kSequences);
  core::parallel_for(kSequences, {},
                     [&](std::size_t n) { found[n] = judged(static_cast<std::uint32_t>(n), 60, 60); });
  struct Bin {
    double said = 0, happened = 0, variance = 0;
    int events = 0;
  };
  std::array<Bin, kBins> bins{};
  double brier = 0, expected = 0, alike = 0, events = 0;
  for (const auto& sequence : found)
    for (const auto& [p, is_true] : sequence) {
      Bin& bin = bins.at(std::min(kBins - 1, static_cast<std::size_t>(p * kBins)));
      bin.said += p, bin.happened += is_true, bin.variance += p * (1 - p), ++bin.events;
      brier += (is_true - p) * (is_true - p), expected += p * (1 - p);
      alike += is_true, ++events;
    }
  for (const Bin& bin : bins) {
    INFO(bin.events << " events, said " << bin.said << ", happened " << bin.happened);
    CHECK(bin.events >= 30);
    CHECK(std::abs(bin.happened - bin.said) < 3 * std::sqrt(bin.variance + 1));
  }
  // As small as calibrated probabilities make it, and far below what one probability for all would have.
  const double share = alike / events;
  INFO("Brier score " << brier / events << ", expected " << expected / events << ", of " << events);
  CHECK(std::abs(brier - expected) < 0.1 * expected);
  CHECK(brier < 0.6 * events * share * (1 - share));
}
