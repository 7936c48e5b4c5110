// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/density.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.hpp"

namespace emberfold::mcmc {

namespace {

using graph::Point;
using std::numbers::pi;

constexpr double kLogTwoPi = 1.8378770664093453;
constexpr double kMostDeath = 0.95;  // the death map raises no chance above this

// Log of the share of a normal turn within ±π/2, plus that of the choice between two directions.
double log_half_turn(double sd) {
  return std::log(std::erf(pi / 2 / (sd * std::numbers::sqrt2))) + std::numbers::ln2;
}

// Log of a mixture of two normal densities, one kOutlierScale times wider, given both exponents.
double log_mixed(double narrow, double wide) {
  static const double errs = std::log(kOutlierShare), errs_not = std::log1p(-kOutlierShare);
  const double a = errs_not + narrow, b = errs + wide;
  return a > b ? a + std::log1p(std::exp(b - a)) : b + std::log1p(std::exp(a - b));
}

double log_sum(const double* terms, std::size_t n) {
  const double most = *std::max_element(terms, terms + n);
  if (most == -std::numeric_limits<double>::infinity()) return most;
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += std::exp(terms[i] - most);
  return most + std::log(sum);
}

}  // namespace

Outcome outcome(const HiddenGraph& g, Index v) {
  if (g.continues(v)) return Outcome::survival;
  const std::size_t next = g[v].next.size();
  return next == 0 ? Outcome::death : next == 1 ? Outcome::merge : Outcome::split;
}

std::size_t merge_targets(const HiddenGraph& g, Index v) {
  std::size_t count = 0;
  for (const Index host : g.hosts(v)) count += g.continues(host);
  return count;
}

std::size_t outcome_context_of(const HiddenGraph& g, Index v) {
  std::size_t neighbour_outcome = 0;
  for (const Index u : g[v].edges)
    if (g.precedes(u, v))
      neighbour_outcome = std::max<std::size_t>(neighbour_outcome, g.has_future(u) ? 1 : 2);
  return outcome_context(g[v].edges.size(), g[v].border, neighbour_outcome);
}

std::size_t parent_class(const HiddenGraph& g, Index w) {
  if (g[w].prev.empty()) return 3;
  const std::size_t degree = g[parent(g, w)].edges.size();
  return degree < 2 ? 0 : degree == 2 ? 1 : 2;
}

PreviousAdjacency previous_adjacency(const HiddenGraph& g, Index a, Index b) {
  PreviousAdjacency closest = PreviousAdjacency::apart;
  for (const Index v : g[a].prev)
    for (const Index u : g[b].prev) {
      if (u == v || g[v].edges.has(u)) return PreviousAdjacency::joined;
      if (std::ranges::any_of(g[v].edges, [&](Index x) { return g[x].edges.has(u); }))
        closest = PreviousAdjacency::near;
    }
  return closest;
}

double neighbour_displacement(const HiddenGraph& g, Index v) {
  const Node& node = g[v];
  if (node.edges.empty()) return node.displacement;
  double sum = 0;
  for (const Index u : node.edges) sum += sense(node, g[u]) * g[u].displacement;
  return sum / static_cast<double>(node.edges.size());
}

Density::Scale::Scale(double sd_)
    : sd(sd_), peak(-0.5 * kLogTwoPi - std::log(sd_)), half_precision(0.5 / (sd_ * sd_)) {}

double Density::outlier_probability(double z) {
  const double wide =
      kOutlierShare / kOutlierScale * std::exp(-0.5 * z * z / (kOutlierScale * kOutlierScale));
  return wide / (wide + (1 - kOutlierShare) * std::exp(-0.5 * z * z));
}

Density::Density(const SamplerParameters& theta) : theta_(theta) {
  for (std::size_t place = 0; place < kPlaces; ++place) {
    const double relative = std::exp2(0.5 * (static_cast<double>(place) - kPlaces / 2));
    for (std::size_t c = 0; c < kOutcomeContexts; ++c) {
      auto chance = theta.outcome[c];
      const double death = std::min(std::max(chance[0], kMostDeath), chance[0] * relative);
      for (std::size_t o = 1; o < kOutcomes; ++o) chance[o] *= (1 - death) / (1 - chance[0]);
      chance[0] = death;
      const double no_merge = std::log1p(-chance[3]);
      for (std::size_t o = 0; o < kOutcomes; ++o) {
        with_hosts_[place][c][o] = std::log(chance[o]);
        without_hosts_[place][c][o] = with_hosts_[place][c][o] - no_merge;
      }
    }
  }
  const auto both = [](double p) { return std::array{std::log1p(-p), std::log(p)}; };
  for (std::size_t k = 0; k < kCloseness; ++k) {
    for (std::size_t w = 0; w < 3; ++w) joined_[w][k] = both(theta.join[w][k]);
    for (std::size_t e = 0; e < 2; ++e) closed_[e][k] = both(theta.close[e][k]);
  }
  for (std::size_t k = 0; k < kParentClasses; ++k) log_growth_[k] = std::log(theta.growth[k]);
  log_first_growth_ = std::log(theta.first_growth);
  for (std::size_t e = 0; e < 2; ++e) log_birth_[e] = std::log(theta.birth[e]) - kLogTwoPi;
  for (std::size_t k = 0; k < 3; ++k) log_kinds_[k] = std::log(theta.kinds[k]);
  log_curve_ = std::log1p(-theta.branch) - std::numbers::ln2;
  log_branch_ = std::log(theta.branch / (pi * theta.branch_reach * theta.branch_reach)) - kLogTwoPi;
  log_same_kind_ = std::log1p(-theta.other_kind), log_other_kind_ = std::log(theta.other_kind / 2);
  const Autoregression& m = theta.displacement;
  lag_one_ = m.a1 / (1 - m.a2);
  // Box & Jenkins 1976, eq. 3.2.28.
  stationary_ = m.noise * m.noise * (1 - m.a2) / ((1 + m.a2) * ((1 - m.a2) * (1 - m.a2) - m.a1 * m.a1));
  begins_ = Scale(std::sqrt(stationary_)), noise_ = Scale(m.noise);
  lag_ = Scale(std::sqrt(stationary_ * (1 - lag_one_ * lag_one_)));
  across_ = {Scale(theta.across), Scale(theta.across * theta.split_spread)};
  along_ = {Scale(theta.along), Scale(theta.along * theta.split_spread)};
  flicker_ = Scale(theta.flicker), new_contrast_ = Scale(theta.new_contrast_sd);
  turn_ = Scale(theta.turn), wide_turn_ = Scale(kOutlierScale * theta.turn);
  turn_.peak -= log_half_turn(turn_.sd), wide_turn_.peak -= log_half_turn(wide_turn_.sd);
  step_ = Scale(theta.step_sd), side_ = Scale(theta.side_sd), bend_ = Scale(theta.bend_sd);
  bend_.peak -= log_half_turn(theta.bend_sd);
  grown_contrast_ = Scale(theta.grown_contrast_sd);
  compute_bounds();
}

// Upper bounds of factors: every normal density at its peak, all probabilities of edges 1.
void Density::compute_bounds() {
  const auto at_peak = [](const Scale& a, const Scale& b) { return std::max(a.peak, b.peak); };
  double most_split = -std::numeric_limits<double>::infinity();
  for (std::size_t m = 2; m <= kMostLinks; ++m) most_split = std::max(most_split, log_parts(m));
  for (const auto* table : {&without_hosts_, &with_hosts_})
    for (const auto& place : *table)
      for (const auto& chances : place)
        for (std::size_t o = 0; o < kOutcomes; ++o)
          max_outcome_ = std::max(
              max_outcome_,
              chances[o] + (o == static_cast<std::size_t>(Outcome::split) ? std::max(0.0, most_split) : 0));
  max_survival_ = at_peak(noise_, lag_) + at_peak(across_[0], across_[1]) + at_peak(along_[0], along_[1]) +
                  log_mixed(turn_.peak, wide_turn_.peak) +
                  log_mixed(flicker_.peak, flicker_.peak - std::log(kOutlierScale));
  const double begun =
      std::max(log_birth_[0], log_birth_[1]) + new_contrast_.peak + *std::ranges::max_element(log_kinds_);
  const double rate = std::max(log_first_growth_, *std::ranges::max_element(log_growth_));
  const std::array kernel{log_curve_ + step_.peak + std::numbers::ln2 + side_.peak + bend_.peak, log_branch_};
  const double grown =
      rate + log_sum(kernel.data(), 2) + grown_contrast_.peak + std::max(log_same_kind_, log_other_kind_);
  max_birth_ = begins_.peak + std::max(begun, grown) + std::log(static_cast<double>(kMostEdges + 1));
}

// Log probability of the number of parts of a split, in any order: geometric from two on, at most kMostLinks.
double Density::log_parts(std::size_t parts) const {
  const double more = theta_.split_more, m = static_cast<double>(parts);
  return std::log1p(-more) + (m - 2) * std::log(more) - std::log1p(-std::pow(more, kMostLinks - 1)) +
         std::lgamma(m + 1);
}

double Density::log_outcome(const HiddenGraph& g, Index v) const {
  const Node& node = g[v];
  if (node.frame + 1 == g.frames()) return 0;
  const Outcome what = outcome(g, v);
  const std::size_t targets = merge_targets(g, v);
  const auto& table = targets > 0 ? with_hosts_ : without_hosts_;
  double sum = table[node.place][outcome_context_of(g, v)][static_cast<std::size_t>(what)];
  if (what == Outcome::merge) {
    // The merge goes into one of the targets. The check is here, so that moves need none.
    const auto hosts = g.hosts(v);
    if (std::ranges::find(hosts, parent(g, node.next[0])) == hosts.end())
      return -std::numeric_limits<double>::infinity();
    sum -= std::log(static_cast<double>(targets));
  }
  if (what == Outcome::split) sum += log_parts(node.next.size());
  return sum;
}

Density::Normal Density::displacement_given_past(const HiddenGraph& g, Index w) const {
  const Node& node = g[w];
  if (node.prev.empty()) return {0, stationary_};
  const Index v = parent(g, w);
  return displacement_given_past(g, v, sense(g[v], node));
}

Density::Normal Density::displacement_given_past(const HiddenGraph& g, Index v, double same) const {
  const Node& past = g[v];
  if (past.prev.size() != 1)
    return {same * lag_one_ * past.displacement, stationary_ * (1 - lag_one_ * lag_one_)};
  const Node& before = g[past.prev[0]];
  const Autoregression& m = theta_.displacement;
  const double expected = m.a1 * past.displacement + m.a2 * sense(before, past) * before.displacement +
                          m.coupling * (neighbour_displacement(g, v) - past.displacement);
  return {same * expected, m.noise * m.noise};
}

double Density::stationary_sd() const {
  return std::sqrt(stationary_);
}

double Density::log_displacement(const HiddenGraph& g, Index w) const {
  const Node& node = g[w];
  if (node.prev.empty()) return begins_.log_normal(node.displacement);
  const Index v = parent(g, w);
  const Node& past = g[v];
  const TransitionOffset& offset = g.offset(v, w);
  const double same = offset.sense;
  const double going = past.prev.size() == 1
                           ? noise_.log_normal(node.displacement - displacement_given_past(g, v, same).mean)
                           : lag_.log_normal(node.displacement - same * lag_one_ * past.displacement);
  return going + across_[past.next.size() > 1 ? 1 : 0].log_normal(
                     offset.across - (same * node.displacement - past.displacement));
}

double Density::log_birth_or_survival(const HiddenGraph& g, Index w) const {
  const double sum = log_displacement(g, w);
  const Node& node = g[w];
  if (node.prev.empty()) return sum + log_birth(g, w);
  const Index v = parent(g, w);
  const TransitionOffset& offset = g.offset(v, w);
  const double looks = prepared_ ? offset.log_appearance : log_appearance(offset);
  return sum + along_[g[v].next.size() > 1 ? 1 : 0].log_normal(offset.along) + looks;
}

double Density::log_appearance(const TransitionOffset& offset) const {
  static const double wider = std::log(kOutlierScale);
  const double turn = offset.turn, flicker = offset.flicker;
  return log_mixed(turn_.log_normal(turn), wide_turn_.log_normal(turn)) +
         log_mixed(flicker_.log_normal(flicker), flicker_.log_normal(flicker / kOutlierScale) - wider);
}

void Density::prepare(HiddenGraph& g) {
  constexpr std::size_t kBlock = 512;
  core::parallel_for((g.size() + kBlock - 1) / kBlock, {}, [&](std::size_t block) {
    for (std::size_t v = block * kBlock; v < std::min(g.size(), (block + 1) * kBlock); ++v)
      for (TransitionOffset& offset : g.offsets(static_cast<Index>(v)))
        offset.log_appearance = log_appearance(offset);
  });
  prepared_ = true;
}

double Density::log_new_stroke(const Node& w) const {
  return log_birth_[w.frame == 0 ? 0 : 1] + w.log_birth +
         new_contrast_.log_normal(w.log_contrast - theta_.new_contrast) +
         log_kinds_[static_cast<std::size_t>(w.kind)];
}

double Density::log_grown(const Node& from, const Node& w) const {
  const Point apart = w.patch.position - from.patch.position;
  const double along = std::abs(graph::dot(apart, from.tangent));
  const double terms[2] = {
      log_curve_ + step_.log_normal(along - theta_.step) +
          std::log1p(std::exp(-2 * along * theta_.step / (theta_.step_sd * theta_.step_sd))) +
          side_.log_normal(graph::dot(apart, from.normal())) + bend_.log_normal(turn_between(from, w)),
      graph::dot(apart, apart) <= theta_.branch_reach * theta_.branch_reach
          ? log_branch_
          : -std::numeric_limits<double>::infinity()};
  return log_sum(terms, 2) + grown_contrast_.log_normal(w.log_contrast - from.log_contrast) +
         (from.kind == w.kind ? log_same_kind_ : log_other_kind_);
}

/// Terms of the ways in which a new node can have come, in logarithms.
struct Density::BirthWays {
  ShortList<kMostEdges> from;
  std::array<double, kMostEdges + 1> terms{};  ///< the last of from.size() + 1: begun
  double apart = 0;                            ///< that it is joined to nothing else

  [[nodiscard]] double sum() const { return apart + log_sum(terms.data(), from.size() + 1); }
};

Density::BirthWays Density::birth_ways(const HiddenGraph& g, Index w) const {
  const Node& node = g[w];
  const auto& closed = closed_[node.frame == 0 ? 0 : 1];
  BirthWays result;
  std::array<double, kMostEdges> joined{};
  double all_joined = 0;
  for (const NeighbourCandidate& near : g.neighbours(w)) {
    if (!g.is_active(near.node) || (!g.has_past(near.node) && !near.earlier)) continue;
    if (node.edges.has(near.node)) {
      joined[result.from.size()] = closed[near.closeness][1];
      all_joined += closed[near.closeness][1];
      result.from.push(near.node);
    } else {
      result.apart += closed[near.closeness][0];
    }
  }
  for (std::size_t k = 0; k < result.from.size(); ++k) {
    const Index u = result.from[k];
    const double rate = node.frame == 0 ? log_first_growth_ : log_growth_[parent_class(g, u)];
    result.terms[k] = rate + log_grown(g[u], node) + all_joined - joined[k];
  }
  result.terms[result.from.size()] = log_new_stroke(node) + all_joined;
  return result;
}

double Density::log_birth(const HiddenGraph& g, Index w) const {
  return birth_ways(g, w).sum();
}

Density::Origins Density::origins(const HiddenGraph& g, Index w) const {
  const BirthWays all = birth_ways(g, w);
  const double sum = all.sum() - all.apart;
  Origins result;
  result.from = all.from;
  for (std::size_t k = 0; k < all.from.size(); ++k) result.shares[k] = std::exp(all.terms[k] - sum);
  result.begun = std::exp(all.terms[all.from.size()] - sum);
  return result;
}

double Density::log_presence(const HiddenGraph& g, Index w) const {
  // A new patch grows others only towards those later in order: half of the plane, half of the kernel.
  const double growth = g[w].frame == 0     ? theta_.first_growth / 2
                        : g[w].prev.empty() ? theta_.growth[3] / 2
                                            : theta_.growth[parent_class(g, w)];
  return g[w].evidence - growth;
}

double Density::log_edge(const HiddenGraph& g, Index a, const NeighbourCandidate& b) const {
  if (!g.has_past(a) || !g.has_past(b.node)) return 0;
  const auto& table = joined_[static_cast<std::size_t>(previous_adjacency(g, a, b.node))];
  return table[b.closeness][g[a].edges.has(b.node) ? 1 : 0];
}

double Density::total(const HiddenGraph& g) const {
  const double area = double(g.width()) * g.height();
  return core::deterministic_sum(static_cast<std::size_t>(g.frames()), 4, [&](std::size_t k) {
    const int t = static_cast<int>(k);
    double frame = -theta_.birth[t == 0 ? 0 : 1] * area;
    std::vector<Index> shown(g.active(t).begin(), g.active(t).end());
    std::ranges::sort(shown);
    for (const Index v : shown) {
      frame += log_outcome(g, v) + log_birth_or_survival(g, v) + log_presence(g, v);
      for (const NeighbourCandidate& near : g.neighbours(v))
        if (v < near.node)
          frame += log_edge(g, v, near) + (g[v].edges.has(near.node) ? double{near.evidence} : 0);
    }
    return frame;
  });
}

}  // namespace emberfold::mcmc
