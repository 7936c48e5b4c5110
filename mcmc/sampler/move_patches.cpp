// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mcmc/sampler/choose.hpp"
#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

std::size_t joinable(const HiddenGraph& g, Index a) {
  std::size_t count = 0;
  if (g.is_active(a) && g.has_room(a))
    for (const NeighbourCandidate& b : g.neighbours(a))
      count += g.is_active(b.node) && g.has_room(b.node) && !g[a].edges.has(b.node);
  return count;
}

bool are_neighbours(const HiddenGraph& g, Index a, Index b) {
  return std::ranges::find(g.neighbours(a), b, &NeighbourCandidate::node) != g.neighbours(a).end();
}

// ---- a patch with its connections ----

/// Probability that an added patch is joined to one beside it.
constexpr std::array<double, kCloseness> kEdgeChance = {0.8, 0.4, 0.4, 0.1, 0.1, 0.05};
constexpr double kNoLinkChance = 0.15;  // probability of no predecessor although one is possible

struct Connections {
  ShortList<kMostEdges> edges;
  bool too_many = false;  ///< edges were drawn that it has no room for
  Index prev = kNone, next = kNone;
};

/// Draws the connections of a patch that is off, or computes the log probability of given ones.
class ConnectionChance {
 public:
  ConnectionChance(const HiddenGraph& g, Index i) : g_(g), i_(i) {}

  double draw(ChoiceSource& draws, Connections& connections) {
    double sum = 0;
    for (const NeighbourCandidate& b : g_.neighbours(i_)) {
      if (!can_add_edge(b.node)) continue;
      const double p = kEdgeChance[b.closeness];
      const bool join = draws.pick(std::array{1 - p, p}) == 1;
      sum += log_join(b.closeness, join);
      if (!join) continue;
      if (connections.edges.full())
        connections.too_many = true;
      else
        connections.edges.push(b.node);
    }
    connections.prev = draw_one(
        draws, g_.candidates_before(i_), [&](Index j) { return is_free_before(j); }, sum);
    connections.next = draw_one(
        draws, g_.candidates_after(i_), [&](Index j) { return is_free_after(j); }, sum);
    return sum;
  }
  [[nodiscard]] double log_chance(const Connections& connections) const {
    double sum = 0;
    for (const NeighbourCandidate& b : g_.neighbours(i_))
      if (can_add_edge(b.node)) sum += log_join(b.closeness, connections.edges.has(b.node));
    const std::size_t before = count_if(g_.candidates_before(i_), [&](Index j) { return is_free_before(j); });
    const std::size_t after = count_if(g_.candidates_after(i_), [&](Index j) { return is_free_after(j); });
    return sum + log_link_chance(before, connections.prev != kNone) +
           log_link_chance(after, connections.next != kNone);
  }

 private:
  [[nodiscard]] bool can_add_edge(Index j) const { return g_.is_active(j) && g_.has_room(j); }
  [[nodiscard]] bool is_free_before(Index j) const { return g_.is_active(j) && !g_.has_future(j); }
  [[nodiscard]] bool is_free_after(Index j) const { return g_.is_active(j) && !g_.has_past(j); }
  static double log_join(std::size_t closeness, bool join) {
    static const auto logs = [] {
      std::array<std::array<double, 2>, kCloseness> table{};
      for (std::size_t k = 0; k < kCloseness; ++k)
        table[k] = {std::log(1 - kEdgeChance[k]), std::log(kEdgeChance[k])};
      return table;
    }();
    return logs[closeness][join ? 1 : 0];
  }
  [[nodiscard]] static double log_link_chance(std::size_t choices, bool linked) {
    static const double untied = std::log(kNoLinkChance), not_untied = std::log1p(-kNoLinkChance);
    if (choices == 0) return 0;
    return linked ? not_untied - log_count(choices) : untied;
  }
  template <class Keep>
  static Index draw_one(ChoiceSource& draws, std::span<const Index> list, Keep keep, double& sum) {
    const std::size_t choices = count_if(list, keep);
    if (choices == 0) return kNone;
    const bool linked = draws.pick(std::array{kNoLinkChance, 1 - kNoLinkChance}) == 1;
    sum += log_link_chance(choices, linked);
    return linked ? nth(list, draws.below(choices), keep) : kNone;
  }

  const HiddenGraph& g_;
  Index i_;
};

/// Proposal of an added patch's displacement: the mean of its links' or neighbours', and its SD.
struct Guess {
  double mean = 0, sd = 1;
};
Guess guess_displacement(const HiddenGraph& g, const Density& density, Index i,
                         const Connections& connections) {
  double sum = 0, count = 0;
  for (const Index j : {connections.prev, connections.next})
    if (j != kNone) sum += sense(g[i], g[j]) * g[j].displacement, count += 1;
  const auto& displacement = density.theta().displacement;
  if (count > 0) return {sum / count, 2 * displacement.noise};
  for (const Index j : connections.edges) sum += sense(g[i], g[j]) * g[j].displacement, count += 1;
  return {count > 0 ? sum / count : 0, density.stationary_sd()};
}
double log_density(const Guess& guess, double displacement) {
  const double z = (displacement - guess.mean) / guess.sd;
  return -0.5 * z * z - std::log(guess.sd) - 0.9189385332046727;
}

std::optional<double> add_patch(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t choices = g.inactive(frame).size();
  if (choices == 0) return std::nullopt;
  const Index i = g.inactive(frame)[draws.below(choices)];
  if (!g.can_activate(i)) return std::nullopt;
  Connections connections;
  const double chance = ConnectionChance(g, i).draw(draws, connections);
  if (connections.too_many) return std::nullopt;
  const Guess guess = guess_displacement(g, change.density(), i, connections);
  const double displacement = draws.normal(guess.mean, guess.sd);
  change.activate(i);
  change.set_displacement(i, displacement);
  for (const Index j : connections.edges) change.add_edge(i, j);
  if (connections.prev != kNone) change.link(connections.prev, i);
  if (connections.next != kNone) change.link(i, connections.next);
  return log_count(choices) - log_count(g.active(frame).size()) - chance - log_density(guess, displacement);
}

std::optional<double> delete_patch(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t choices = g.active(frame).size();
  if (choices == 0) return std::nullopt;
  const Index i = g.active(frame)[draws.below(choices)];
  Connections connections;
  for (const auto* links : {&g[i].prev, &g[i].next}) {
    if (links->empty()) continue;
    const Index j = (*links)[0];
    if (links->size() > 1 || (links == &g[i].prev ? g[j].next : g[j].prev).size() > 1) return std::nullopt;
    (links == &g[i].prev ? connections.prev : connections.next) = j;
  }
  connections.edges = g[i].edges;
  const double displacement = g[i].displacement;
  if (connections.prev != kNone) change.unlink(connections.prev, i);
  if (connections.next != kNone) change.unlink(i, connections.next);
  for (const Index j : connections.edges) change.remove_edge(i, j);
  change.deactivate(i);
  const Guess guess = guess_displacement(g, change.density(), i, connections);
  return log_count(choices) - log_count(g.inactive(frame).size()) +
         ConnectionChance(g, i).log_chance(connections) + log_density(guess, displacement);
}

// ---- one patch as two ----

/// Edges and past of v that a split towards i can give away, in the state before the split.
struct Shareable {
  std::size_t candidates = 0;  ///< that v could split towards
  std::vector<Index> edges;
  Index past = kNone;
};
Shareable shareable(const HiddenGraph& g, Index v, Index i) {
  Shareable result;
  for (const NeighbourCandidate& b : g.neighbours(v))
    result.candidates += g.can_activate(b.node) && g[b.node].kind == g[v].kind;
  for (const Index x : g[v].edges)
    if (are_neighbours(g, i, x)) result.edges.push_back(x);
  if (g[v].prev.size() == 1) {
    const Index p = g[v].prev[0];
    if (g.linkable(p, i) && !g[p].next.full()) result.past = p;
  }
  return result;
}
/// Probability of one way of sharing, after the choice of v.
double share_chance(const HiddenGraph& g, Index v, Index i) {
  const Shareable s = shareable(g, v, i);
  return std::exp2(-static_cast<double>(s.edges.size() + (s.past != kNone ? 1 : 0))) /
         static_cast<double>(s.candidates);
}
/// Another node than v that i could be split from, with the same state without i; kNone if there is none. It
/// exists where i lies between just two nodes.
Index alternative_source(const HiddenGraph& g, Index v, Index i) {
  if (g[i].edges.size() != 2) return kNone;
  const Index u = g[i].edges[g[i].edges[0] == v ? 1 : 0];
  if (g[u].kind != g[i].kind || !are_neighbours(g, u, v) || g[u].edges.has(v)) return kNone;
  if (!g[i].prev.empty() && (g[u].prev.size() != 1 || g[u].prev[0] != g[i].prev[0])) return kNone;
  return u;
}

/// Proposal of a part's displacement.
Guess guess_part(const HiddenGraph& g, const Density& density, Index v, Index i) {
  return {sense(g[i], g[v]) * g[v].displacement, density.theta().displacement.noise};
}

/// Probability of one way of sharing times the density of the displacement.
double way_chance(const HiddenGraph& g, const Density& density, Index v, Index i, double displacement) {
  return share_chance(g, v, i) * std::exp(log_density(guess_part(g, density, v, i), displacement));
}

std::optional<double> split_patch(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t one = g.active(frame).size();
  if (one == 0) return std::nullopt;
  const Index v = g.active(frame)[draws.below(one)];
  std::vector<Index> candidates;
  for (const NeighbourCandidate& b : g.neighbours(v))
    if (g.can_activate(b.node) && g[b.node].kind == g[v].kind) candidates.push_back(b.node);
  if (candidates.empty()) return std::nullopt;
  const Index i = candidates[draws.below(candidates.size())];
  const Shareable can = shareable(g, v, i);
  std::vector<Index> given;
  for (const Index x : can.edges)
    if (draws.coin()) given.push_back(x);
  const bool gives_past = can.past != kNone && draws.coin();
  const Guess guess = guess_part(g, change.density(), v, i);
  const double displacement = draws.normal(guess.mean, guess.sd);
  // Between two nodes it could have been split from the other one, too.
  double there = way_chance(g, change.density(), v, i, displacement);
  const double other = given.size() == 1 && g[given[0]].kind == g[v].kind
                           ? way_chance(g, change.density(), given[0], i, displacement)
                           : 0;
  change.activate(i);
  change.set_displacement(i, displacement);
  for (const Index x : given) {
    change.remove_edge(v, x);
    change.add_edge(i, x);
  }
  if (!g.can_add_edge(v, i)) {
    change.rollback();
    return std::nullopt;
  }
  change.add_edge(v, i);
  if (gives_past) change.link(can.past, i);
  std::size_t into = 0;
  for (const Index x : g[i].edges) into += g[x].kind == g[i].kind;
  const bool two_ways = alternative_source(g, v, i) != kNone;
  if (two_ways) there += other;
  return log_count(one) - std::log(there) - log_count(g.active(frame).size()) + log_count(two_ways ? 2 : 1) -
         log_count(into);
}

std::optional<double> merge_patches(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t two = g.active(frame).size();
  if (two == 0) return std::nullopt;
  const Index i = g.active(frame)[draws.below(two)];
  std::vector<Index> into;
  for (const Index x : g[i].edges)
    if (g[x].kind == g[i].kind) into.push_back(x);
  if (into.empty()) return std::nullopt;
  const Index v = into[draws.below(into.size())];
  if (!g[i].next.empty() || g[i].prev.size() > 1) return std::nullopt;
  const Index past = g[i].prev.empty() ? kNone : g[i].prev[0];
  if (past != kNone && (g[v].prev.size() != 1 || g[v].prev[0] != past)) return std::nullopt;
  const Index other = alternative_source(g, v, i);
  std::vector<Index> given;
  for (const Index x : g[i].edges) {
    if (x == v) continue;
    if (!are_neighbours(g, v, x) || g[v].edges.has(x)) return std::nullopt;
    given.push_back(x);
  }
  const double displacement = g[i].displacement;
  if (past != kNone) change.unlink(past, i);
  change.remove_edge(v, i);
  for (const Index x : given) {
    change.remove_edge(i, x);
    if (!g.can_add_edge(v, x)) {
      change.rollback();
      return std::nullopt;
    }
    change.add_edge(v, x);
  }
  change.deactivate(i);
  double back = way_chance(g, change.density(), v, i, displacement);
  if (other != kNone) back += way_chance(g, change.density(), other, i, displacement);
  return log_count(two) + log_count(into.size()) - log_count(other != kNone ? 2 : 1) -
         log_count(g.active(frame).size()) + std::log(back);
}

}  // namespace

std::optional<double> connect_or_cut(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const bool connect = draws.coin();
  if (g.active(frame).empty()) return std::nullopt;
  const Index a = g.active(frame)[draws.below(g.active(frame).size())];
  // Either end may be drawn first.
  const auto either = [](std::size_t m, std::size_t n) {
    return log_count(m + n) - log_count(m) - log_count(n);
  };
  if (connect) {
    const std::size_t choices = joinable(g, a);
    if (choices == 0) return std::nullopt;
    std::size_t n = draws.below(choices);
    Index b = kNone;
    for (const NeighbourCandidate& near : g.neighbours(a))
      if (g.can_add_edge(a, near.node) && n-- == 0) b = near.node;
    const double there = either(choices, joinable(g, b));
    change.add_edge(a, b);
    return either(g[a].edges.size(), g[b].edges.size()) - there;
  }
  if (g[a].edges.empty()) return std::nullopt;
  const Index b = g[a].edges[draws.below(g[a].edges.size())];
  const double there = either(g[a].edges.size(), g[b].edges.size());
  change.remove_edge(a, b);
  return either(joinable(g, a), joinable(g, b)) - there;
}

std::optional<double> add_or_delete(StateChange& change, ChoiceSource& draws, int frame) {
  return draws.coin() ? add_patch(change, draws, frame) : delete_patch(change, draws, frame);
}

std::optional<double> split_or_merge(StateChange& change, ChoiceSource& draws, int frame) {
  return draws.coin() ? split_patch(change, draws, frame) : merge_patches(change, draws, frame);
}

}  // namespace emberfold::mcmc
