// SPDX-License-Identifier: Apache-2.0
// Hidden graphs of a few nodes, whose states can be counted, and draws that can be steered.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "mcmc/sampler/prior_simulation.hpp"
#include "mcmc/sampler/ratio_check.hpp"

namespace emberfold::test {

using mcmc::Density;
using mcmc::Gates;
using mcmc::HiddenGraph;
using mcmc::Index;
using mcmc::SamplerParameters;
using mcmc::StateChange;

inline graph::Patch patch(double x, double y, double theta = 0.1, double contrast = 20) {
  graph::Patch p;
  p.position = {x, y};
  p.theta = theta;
  p.contrast = contrast;
  p.width = 2;
  return p;
}
inline graph::Patch step_patch(double x, double y, double theta = 0.1, double contrast = 20) {
  auto p = patch(x, y, theta, contrast);
  p.width = 0;
  return p;
}

/// Every chance another, and none so small that a state has no weight.
inline mcmc::SamplerParameters even_theta() {
  auto theta = mcmc::default_parameters(3, 3600);
  for (std::size_t c = 0; c < mcmc::kOutcomeContexts; ++c) {
    const double shift = 0.01 * static_cast<double>(c);
    theta.outcome[c] = {0.2 + shift, 0.6 - shift, 0.12, 0.08};
  }
  for (std::size_t k = 0; k < mcmc::kCloseness; ++k) {
    const double by = 0.03 * static_cast<double>(k);
    theta.join[2][k] = 0.9 - by, theta.join[0][k] = 0.3 - by, theta.join[1][k] = 0.5 - by;
    theta.close[0][k] = 0.35 - by, theta.close[1][k] = 0.25 - by;
  }
  theta.birth = {0.002, 0.001};
  theta.growth = {0.3, 0.2, 0.25, 1.1};
  theta.first_growth = 1.3;
  theta.along = 4, theta.across = 3, theta.turn = 0.4, theta.flicker = 0.5;
  theta.step_sd = 3, theta.side_sd = 2, theta.bend_sd = 0.5;
  theta.displacement = {1.2, -0.5, 0.1, 0.8, 0, 0};
  return theta;
}

/// As the one before, but its draws end and stay within gates of 12 px: for forward simulation.
inline mcmc::SamplerParameters lively_theta() {
  auto theta = mcmc::default_parameters(5, 2500);
  for (std::size_t c = 0; c < mcmc::kOutcomeContexts; ++c) {
    const double death = 0.15 + 0.01 * static_cast<double>(c % 7);
    theta.outcome[c] = {death, 1 - death - 0.1 - 0.08, 0.1, 0.08};
  }
  theta.along = 1, theta.across = 0.7, theta.turn = 0.2, theta.flicker = 0.1;
  theta.step = 4, theta.step_sd = 0.5, theta.branch_reach = 9;
  theta.birth = {0.0012, 0.0006};
  theta.growth = {0.2, 0.1, 0.15, 0.9};
  theta.first_growth = 1;
  theta.displacement = {1.2, -0.5, 0.1, 0.3, 0, 0};
  theta.new_contrast_sd = 0.2;
  theta.kinds = {0.5, 0.3, 0.2};
  theta.other_kind = 0.05;
  for (std::size_t k = 0; k < mcmc::kCloseness; ++k) {
    const double by = 0.01 * static_cast<double>(k);
    theta.join[2][k] = 0.9 - 10 * by, theta.join[0][k] = 0.2 - 3 * by, theta.join[1][k] = 0.5 - 5 * by;
    theta.close[0][k] = 0.2 - 3 * by, theta.close[1][k] = 0.18 - 2 * by;
  }
  return theta;
}
constexpr mcmc::Gates kLivelyGates{10, 12, 0};

/// Evidence, places on the maps and drifts, another for each node.
inline void furnish(HiddenGraph& g) {
  for (Index i = 0; i < g.size(); ++i) {
    g.set_evidence(i, 1.5 + 0.3 * i);
    g.set_map_values(i, 0.1 * i, static_cast<std::uint8_t>((2 * i) % mcmc::kPlaces), {0.1 * (i % 3), 0.2});
  }
}

inline Index shown(HiddenGraph& g, int frame, const graph::Patch& p) {
  const Index i = g.add_candidate(frame, p);
  g.activate(i);
  return i;
}

/// A row of patches 5 px apart, joined or not; all on. Returns the first.
inline Index row(HiddenGraph& g, int frame, int count, double x, double y, bool joined = true) {
  const auto first = static_cast<Index>(g.size());
  for (int k = 0; k < count; ++k) {
    const Index i = shown(g, frame, patch(x + 5 * k, y));
    if (joined && k > 0) g.add_edge(i - 1, i);
  }
  return first;
}

/// The chance that a test calls the draws of: `normal` always gives the same number; the others go every way
/// in turn.
class AllDraws final : public mcmc::ChoiceSource {
 public:
  /// `normals`: what normal draws give, in their order.
  explicit AllDraws(std::vector<double> normals) : normals_(std::move(normals)) {}
  std::size_t below(std::size_t count) override {
    return branch(std::vector<double>(count, 1 / static_cast<double>(count)));
  }
  std::size_t pick(std::span<const double> weights) override {
    return branch({weights.begin(), weights.end()});
  }
  double normal(double mean, double sd) override {
    const double drawn = next_ < normals_.size() ? normals_[next_] : 0, z = (drawn - mean) / sd;
    ++next_;
    chance_ *= std::exp(-0.5 * z * z) / (sd * std::sqrt(2 * std::numbers::pi));
    return drawn;
  }
  [[nodiscard]] double chance() const { return chance_; }
  /// On to the next way; false after the last.
  bool advance() {
    chance_ = 1, at_ = next_ = 0;
    while (!taken_.empty() && taken_.back() + 1 == counts_.back()) taken_.pop_back(), counts_.pop_back();
    if (taken_.empty()) return false;
    ++taken_.back();
    return true;
  }

 private:
  std::size_t branch(const std::vector<double>& weights) {
    if (at_ == taken_.size()) taken_.push_back(0), counts_.push_back(weights.size());
    chance_ *= weights[taken_[at_]];
    return taken_[at_++];
  }
  std::vector<double> normals_;
  double chance_ = 1;
  std::vector<std::size_t> taken_, counts_;
  std::size_t at_ = 0, next_ = 0;
};

/// A move of moves(), as the checker takes it.
inline mcmc::CheckedMove checked(const mcmc::Move& move) {
  return [&move](mcmc::StateChange& change, mcmc::ChoiceSource& draws, int frame) -> std::optional<double> {
    if (move.between_frames && frame + 1 >= change.state().frames()) return std::nullopt;
    return move.propose(change, draws, frame);
  };
}
inline const mcmc::Move& move_named(std::string_view name) {
  for (const auto& move : mcmc::moves())
    if (move.name == name) return move;
  throw std::logic_error("no such move");
}

/// A state drawn from the density, and candidates strewn about it that are off.
inline HiddenGraph drawn_state(std::uint32_t number, int frames = 3, double size = 50, int candidates = 8,
                               double overlap = 0) {
  core::Rng rng(11, {number, 0, 0});
  auto gates = kLivelyGates;
  gates.overlap = overlap;
  const int side = static_cast<int>(size);
  auto g = mcmc::simulate_prior(lively_theta(), side, side, frames, gates, rng);
  for (int k = 0; k < candidates; ++k) {
    const int frame = static_cast<int>(rng.below(static_cast<std::uint32_t>(frames)));
    graph::Point at{rng.uniform(0, size), rng.uniform(0, size)};
    const auto on = g.active(frame);
    double contrast = rng.uniform(15, 25) * (rng.below(4) == 0 ? -1 : 1);
    if (!on.empty() && rng.below(4) > 0) {
      const auto& near = g[on[rng.below(static_cast<std::uint32_t>(on.size()))]].patch;
      at = near.position + graph::Point{rng.uniform(-7, 7), rng.uniform(-7, 7)};
      contrast = std::abs(contrast) * (near.contrast < 0 ? -1 : 1);
    }
    g.add_candidate(frame, patch(at.x, at.y, rng.uniform(-3, 3), contrast));
  }
  furnish(g);
  // No stroke begins at these candidates; they must have grown.
  for (int t = 0; t < frames; ++t)
    for (const Index i : g.inactive(t))
      if (i % 3 == 0) g.set_map_values(i, -std::numeric_limits<double>::infinity(), g[i].place, g[i].drift);
  return g;
}

}  // namespace emberfold::test
