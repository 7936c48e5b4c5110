// SPDX-License-Identifier: Apache-2.0
// A chain whose patches are born anywhere, so that its law can be held against forward simulation; and the
// law of rates given a state, by conjugate priors.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/mcmc/sampler/small_models.hpp"

namespace emberfold::test {

using mcmc::SamplerParameters;

/// The first `below` is told, the others are drawn.
class FirstCoin final : public mcmc::ChoiceSource {
 public:
  FirstCoin(bool side, mcmc::ChoiceSource& others) : side_(side), others_(others) {}
  std::size_t below(std::size_t count) override {
    return std::exchange(first_, false) ? std::size_t{side_} : others_.below(count);
  }
  std::size_t pick(std::span<const double> weights) override { return others_.pick(weights); }
  double normal(double mean, double sd) override { return others_.normal(mean, sd); }

 private:
  bool side_, first_ = true;
  mcmc::ChoiceSource& others_;
};

/// A patch, and how far from it others like it may lie, px.
struct Like {
  graph::Patch patch;
  double spread = 1;
};

/// A broad density of patches, with respect to px², rad, the logarithm of the contrast, and kinds: anywhere,
/// or like one of those given.
class Broad {
 public:
  Broad(double size, std::vector<Like> models) : size_(size), models_(std::move(models)) {}

  graph::Patch draw(core::Rng& rng) const {
    if (models_.empty() || rng.uniform() < kAnywhere)
      return shaped({rng.uniform(-kMargin, size_ + kMargin), rng.uniform(-kMargin, size_ + kMargin)},
                    rng.uniform(-std::numbers::pi, std::numbers::pi), 3 + 0.4 * rng.normal(), rng.below(3));
    const auto& [m, spread] = models_[rng.below(static_cast<std::uint32_t>(models_.size()))];
    const graph::Point at = m.position + graph::Point{spread * rng.normal(), spread * rng.normal()};
    double theta = rng.uniform(-std::numbers::pi, std::numbers::pi);
    if (rng.uniform() < 0.7) {
      double turn = 0;
      do turn = kTurn * rng.normal();
      while (std::abs(turn) > std::numbers::pi / 2);
      theta = m.theta + turn + (rng.below(2) == 1 ? std::numbers::pi : 0);
    }
    const auto kind = static_cast<std::uint32_t>(mcmc::kind(m));
    const double contrast = std::log1p(std::abs(m.contrast)) + kContrast * rng.normal();
    return shaped(at, std::remainder(theta, 2 * std::numbers::pi), contrast,
                  rng.uniform() < 0.9 ? kind : (kind + 1 + rng.below(2)) % 3);
  }

  [[nodiscard]] double log_density(const graph::Patch& p) const {
    const double contrast = std::log1p(std::abs(p.contrast));
    const bool inside = std::max(std::abs(p.position.x - size_ / 2), std::abs(p.position.y - size_ / 2)) <=
                        size_ / 2 + kMargin;
    const double side = size_ + 2 * kMargin;
    const double anywhere = inside ? normal(contrast - 3, 0.4) / (side * side * 2 * std::numbers::pi * 3) : 0;
    double like = 0;
    for (const auto& [m, spread] : models_) {
      const auto apart = p.position - m.position;
      double turn = std::remainder(p.theta - m.theta, std::numbers::pi);
      const double turned =
          normal(turn, kTurn) / std::erf(std::numbers::pi / 2 / (kTurn * std::numbers::sqrt2)) / 2;
      like += normal(apart.x, spread) * normal(apart.y, spread) *
              (0.7 * turned + 0.3 / (2 * std::numbers::pi)) *
              normal(contrast - std::log1p(std::abs(m.contrast)), kContrast) *
              (mcmc::kind(m) == mcmc::kind(p) ? 0.9 : 0.05);
    }
    if (models_.empty()) return std::log(anywhere);
    return std::log(kAnywhere * anywhere + (1 - kAnywhere) * like / static_cast<double>(models_.size()));
  }

 private:
  static constexpr double kAnywhere = 0.2, kMargin = 6, kTurn = 0.3, kContrast = 0.25;
  static double normal(double x, double sd) {
    return std::exp(-0.5 * x * x / (sd * sd)) / (sd * std::sqrt(2 * std::numbers::pi));
  }
  static graph::Patch shaped(graph::Point at, double theta, double log_contrast, std::uint32_t kind) {
    graph::Patch p;
    p.position = at;
    p.theta = theta;
    p.width = kind == 2 ? 0 : 2;
    p.contrast = (kind == 1 ? -1 : 1) * std::expm1(log_contrast);
    return p;
  }
  double size_;
  std::vector<Like> models_;
};

/// Beyond the frame nothing begins.
inline void place(HiddenGraph& g, Index i) {
  const auto p = g[i].patch.position;
  if (!(p.x >= 0 && p.y >= 0 && p.x <= g.width() && p.y <= g.height()))
    g.set_map_values(i, -std::numeric_limits<double>::infinity(), mcmc::kPlaces / 2, {});
}

/// The state without what is off.
inline HiddenGraph compacted(const HiddenGraph& g, const mcmc::Gates& gates) {
  HiddenGraph result(g.width(), g.height(), g.frames(), gates);
  std::vector<Index> now(g.size(), mcmc::kNone);
  for (Index i = 0; i < g.size(); ++i) {
    if (!g[i].active) continue;
    now[i] = shown(result, g[i].frame, g[i].patch);
    place(result, now[i]);
    result.set_displacement(now[i], g[i].displacement);
  }
  for (Index i = 0; i < g.size(); ++i) {
    if (!g[i].active) continue;
    for (const Index j : g[i].edges)
      if (i < j) result.add_edge(now[i], now[j]);
    for (const Index j : g[i].next) {
      result.allow_link(now[i], now[j]);
      result.link(now[i], now[j]);
    }
  }
  return result;
}

/// Every patch is on; frames are square. Each step is reversible, and so is a step drawn at random.
class FreeChain {
 public:
  FreeChain(HiddenGraph start, const SamplerParameters& theta, const mcmc::Gates& gates, const core::Rng& rng)
      : g_(std::move(start)), density_(theta), gates_(gates), rng_(rng), draws_(fork()) {
    cache_.resize(20000);
  }
  FreeChain(const FreeChain&) = delete;
  FreeChain& operator=(const FreeChain&) = delete;

  [[nodiscard]] const HiddenGraph& state() const { return g_; }
  [[nodiscard]] const mcmc::Density& density() const { return density_; }
  void set_theta(const SamplerParameters& theta) { density_ = mcmc::Density(theta); }
  core::Rng& rng() { return rng_; }

  /// A move of moves(); where it adds or takes out patches, of any patch.
  void step(const mcmc::Move& move) {
    const int frames = g_.frames() - (move.between_frames ? 1 : 0);
    const int frame = static_cast<int>(rng_.below(static_cast<std::uint32_t>(frames)));
    if (move.propose == mcmc::add_or_delete || move.propose == mcmc::split_or_merge) {
      rng_.below(2) == 1 ? more(move, frame) : fewer(move, frame);
      return;
    }
    if (const auto ratio = move.propose(change_, draws_, frame)) accept(*ratio);
  }
  void move_displacement() {
    const int frame = static_cast<int>(rng_.below(static_cast<std::uint32_t>(g_.frames())));
    const auto on = g_.active(frame);
    if (on.empty()) return;
    const Index i = on[rng_.below(static_cast<std::uint32_t>(on.size()))];
    change_.set_displacement(i, g_[i].displacement + 0.6 * rng_.normal());
    accept(0);
  }
  /// Any of them that work on patches anywhere; `patches`: also those that add patches or take them out.
  void step(bool patches) {
    const auto all = mcmc::moves();
    // Patches are hardest to move: half of the steps are theirs.
    const auto which = rng_.below(patches ? 20 : 8);
    if (which >= 16) return step(move_named("split, merge"));
    if (which >= 8) return step(move_named("add, delete"));
    if (which == 7) return move_displacement();
    std::array<const mcmc::Move*, 7> ties{};
    std::size_t n = 0;
    for (const auto& move : all)
      if (!move.over_time && move.propose != mcmc::add_or_delete && move.propose != mcmc::split_or_merge)
        ties[n++] = &move;
    step(*ties[which]);
  }
  [[nodiscard]] std::size_t accepted() const { return accepted_; }

 private:
  core::Rng fork() { return core::Rng(std::uint64_t{rng_.bits()} << 32U | rng_.bits(), {1, 2, 3}); }
  bool accept(double ratio) {
    const bool yes = std::log1p(-rng_.uniform()) < change_.gain() + ratio;
    yes ? change_.commit() : change_.rollback();
    accepted_ += yes;
    return yes;
  }
  [[nodiscard]] Broad broad(int frame) const {
    std::vector<Like> models;
    for (int t = std::max(0, frame - 1); t <= std::min(frame + 1, g_.frames() - 1); ++t)
      for (const Index i : g_.active(t)) models.push_back({g_[i].patch, t == frame ? 3.5 : 2});
    return {static_cast<double>(g_.width()), std::move(models)};
  }
  void more(const mcmc::Move& move, int frame) {
    const Broad any = broad(frame);
    const auto patch = any.draw(rng_);
    place(g_, g_.add_candidate(frame, patch));
    FirstCoin draws(true, draws_);
    const auto ratio = move.propose(change_, draws, frame);
    if (!ratio || !accept(*ratio - any.log_density(patch))) g_.drop_newest_candidate();
  }
  void fewer(const mcmc::Move& move, int frame) {
    FirstCoin draws(false, draws_);
    const auto ratio = move.propose(change_, draws, frame);
    if (!ratio) return;
    const Index gone = g_.inactive(frame)[0];
    if (accept(*ratio + broad(frame).log_density(g_[gone].patch))) g_ = compacted(g_, gates_);
  }

  HiddenGraph g_;
  mcmc::Density density_;
  mcmc::Gates gates_;
  core::Rng rng_;
  mcmc::RandomChoices draws_;
  mcmc::FactorCache cache_;
  mcmc::StateChange change_{g_, density_, cache_};
  std::size_t accepted_ = 0;
};

// ---- what a state shows ----

struct Statistic {
  std::string name;
  double value = 0;
};

inline std::vector<Statistic> statistics(const HiddenGraph& g) {
  std::vector<Statistic> all;
  for (int t = 0; t < g.frames(); ++t) {
    double edges = 0, newborns = 0, displacement = 0, joined = 0, links = 0, splits = 0, merges = 0,
           deaths = 0, along = 0, across = 0;
    for (const Index i : g.active(t)) {
      const auto& node = g[i];
      edges += static_cast<double>(node.edges.size()) / 2;
      joined += node.edges.size() > 1;
      displacement += node.displacement * node.displacement;
      if (t > 0 && !node.prev.empty()) {
        const auto& past = g[mcmc::parent(g, i)];
        const auto moved = node.patch.position - past.patch.position;
        along += std::pow(graph::dot(moved, past.tangent), 2);
        across += std::pow(graph::dot(moved, past.normal()), 2);
      }
      newborns += node.prev.empty();
      links += static_cast<double>(node.next.size());
      if (t + 1 == g.frames()) continue;
      splits += outcome(g, i) == mcmc::Outcome::split;
      merges += outcome(g, i) == mcmc::Outcome::merge;
      deaths += outcome(g, i) == mcmc::Outcome::death;
    }
    const auto add = [&](const char* name, double value) {
      all.push_back({name + (" in frame " + std::to_string(t)), value});
    };
    const auto nodes = static_cast<double>(g.active(t).size());
    add("nodes", nodes), add("nodes squared", nodes * nodes), add("edges", edges), add("inner nodes", joined);
    add("sway squared", displacement);
    if (t > 0) add("newborns", newborns), add("along squared", along), add("across squared", across);
    if (t + 1 < g.frames()) {
      add("links", links), add("splits", splits), add("merges", merges), add("deaths", deaths);
    }
  }
  return all;
}

/// Mean and its error.
struct Mean {
  double value = 0, error = 0;
};
inline Mean mean_of(const std::vector<double>& x) {
  double sum = 0, squares = 0;
  for (const double v : x) sum += v;
  const double mean = sum / static_cast<double>(x.size());
  for (const double v : x) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / static_cast<double>(x.size() - 1) / static_cast<double>(x.size()))};
}
/// Mean of a chain, with its error from the means of 50 batches.
inline Mean mean_of_chain(const std::vector<double>& x) {
  constexpr std::size_t kBatches = 50;
  std::vector<double> batches;
  const std::size_t each = x.size() / kBatches;
  for (std::size_t b = 0; b < kBatches; ++b) {
    double sum = 0;
    for (std::size_t i = b * each; i < (b + 1) * each; ++i) sum += x[i];
    batches.push_back(sum / static_cast<double>(each));
  }
  return mean_of(batches);
}
inline double z_score(const Mean& a, const Mean& b) {
  const double error = std::hypot(a.error, b.error);
  return error > 0 ? (a.value - b.value) / error : (a.value == b.value ? 0 : 1e9);
}

}  // namespace emberfold::test
