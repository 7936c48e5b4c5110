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
  if (g.is_on(a) && g.has_room(a))
    for (const Beside& b : g.beside(a))
      count += g.is_on(b.node) && g.has_room(b.node) && !g[a].edges.has(b.node);
  return count;
}

bool gated(const HiddenGraph& g, Index a, Index b) {
  return std::ranges::find(g.beside(a), b, &Beside::node) != g.beside(a).end();
}

// ---- a patch with its ties ----

/// By which chance a patch that is put in is joined to one beside it.
constexpr std::array<double, kCloseness> kJoin = {0.8, 0.4, 0.4, 0.1, 0.1, 0.05};
constexpr double kUntied = 0.15;  // by which it has no predecessor although there could be one

struct Ties {
  ShortList<kMostEdges> edges;
  bool too_many = false;  ///< edges were drawn that it has no room for
  Index prev = kNone, next = kNone;
};

/// Draws the ties of a patch that is off, or tells the log chance of given ones.
class TieChance {
 public:
  TieChance(const HiddenGraph& g, Index i) : g_(g), i_(i) {}

  double draw(Draws& draws, Ties& ties) {
    double sum = 0;
    for (const Beside& b : g_.beside(i_)) {
      if (!can_join(b.node)) continue;
      const double p = kJoin[b.closeness];
      const bool join = draws.pick(std::array{1 - p, p}) == 1;
      sum += log_join(b.closeness, join);
      if (!join) continue;
      if (ties.edges.full())
        ties.too_many = true;
      else
        ties.edges.push(b.node);
    }
    ties.prev = draw_one(
        draws, g_.behind(i_), [&](Index j) { return is_free_before(j); }, sum);
    ties.next = draw_one(
        draws, g_.ahead(i_), [&](Index j) { return is_free_after(j); }, sum);
    return sum;
  }
  [[nodiscard]] double of(const Ties& ties) const {
    double sum = 0;
    for (const Beside& b : g_.beside(i_))
      if (can_join(b.node)) sum += log_join(b.closeness, ties.edges.has(b.node));
    const std::size_t before = count_if(g_.behind(i_), [&](Index j) { return is_free_before(j); });
    const std::size_t after = count_if(g_.ahead(i_), [&](Index j) { return is_free_after(j); });
    return sum + of_one(before, ties.prev != kNone) + of_one(after, ties.next != kNone);
  }

 private:
  [[nodiscard]] bool can_join(Index j) const { return g_.is_on(j) && g_.has_room(j); }
  [[nodiscard]] bool is_free_before(Index j) const { return g_.is_on(j) && !g_.has_future(j); }
  [[nodiscard]] bool is_free_after(Index j) const { return g_.is_on(j) && !g_.has_past(j); }
  static double log_join(std::size_t closeness, bool join) {
    static const auto logs = [] {
      std::array<std::array<double, 2>, kCloseness> table{};
      for (std::size_t k = 0; k < kCloseness; ++k) table[k] = {std::log(1 - kJoin[k]), std::log(kJoin[k])};
      return table;
    }();
    return logs[closeness][join ? 1 : 0];
  }
  [[nodiscard]] static double of_one(std::size_t choices, bool tied) {
    static const double untied = std::log(kUntied), not_untied = std::log1p(-kUntied);
    if (choices == 0) return 0;
    return tied ? not_untied - log_count(choices) : untied;
  }
  template <class Keep>
  static Index draw_one(Draws& draws, std::span<const Index> list, Keep keep, double& sum) {
    const std::size_t choices = count_if(list, keep);
    if (choices == 0) return kNone;
    const bool tied = draws.pick(std::array{kUntied, 1 - kUntied}) == 1;
    sum += of_one(choices, tied);
    return tied ? nth(list, draws.below(choices), keep) : kNone;
  }

  const HiddenGraph& g_;
  Index i_;
};

/// The sway that a patch put in is likely to have: its partners', and how far off that may be.
struct Guess {
  double mean = 0, sd = 1;
};
Guess guess_sway(const HiddenGraph& g, const Density& density, Index i, const Ties& ties) {
  double sum = 0, count = 0;
  for (const Index j : {ties.prev, ties.next})
    if (j != kNone) sum += sense(g[i], g[j]) * g[j].sway, count += 1;
  const auto& sway = density.theta().sway;
  if (count > 0) return {sum / count, 2 * sway.noise};
  for (const Index j : ties.edges) sum += sense(g[i], g[j]) * g[j].sway, count += 1;
  return {count > 0 ? sum / count : 0, density.stationary_sd()};
}
double log_density(const Guess& guess, double sway) {
  const double z = (sway - guess.mean) / guess.sd;
  return -0.5 * z * z - std::log(guess.sd) - 0.9189385332046727;
}

std::optional<double> add(Edit& edit, Draws& draws, int frame) {
  const HiddenGraph& g = edit.state();
  const std::size_t choices = g.off(frame).size();
  if (choices == 0) return std::nullopt;
  const Index i = g.off(frame)[draws.below(choices)];
  if (!g.can_put(i)) return std::nullopt;
  Ties ties;
  const double chance = TieChance(g, i).draw(draws, ties);
  if (ties.too_many) return std::nullopt;
  const Guess guess = guess_sway(g, edit.density(), i, ties);
  const double sway = draws.normal(guess.mean, guess.sd);
  edit.put(i);
  edit.set_sway(i, sway);
  for (const Index j : ties.edges) edit.join(i, j);
  if (ties.prev != kNone) edit.link(ties.prev, i);
  if (ties.next != kNone) edit.link(i, ties.next);
  return log_count(choices) - log_count(g.on(frame).size()) - chance - log_density(guess, sway);
}

std::optional<double> take(Edit& edit, Draws& draws, int frame) {
  const HiddenGraph& g = edit.state();
  const std::size_t choices = g.on(frame).size();
  if (choices == 0) return std::nullopt;
  const Index i = g.on(frame)[draws.below(choices)];
  Ties ties;
  for (const auto* links : {&g[i].prev, &g[i].next}) {
    if (links->empty()) continue;
    const Index j = (*links)[0];
    if (links->size() > 1 || (links == &g[i].prev ? g[j].next : g[j].prev).size() > 1) return std::nullopt;
    (links == &g[i].prev ? ties.prev : ties.next) = j;
  }
  ties.edges = g[i].edges;
  const double sway = g[i].sway;
  if (ties.prev != kNone) edit.unlink(ties.prev, i);
  if (ties.next != kNone) edit.unlink(i, ties.next);
  for (const Index j : ties.edges) edit.cut(i, j);
  edit.take(i);
  const Guess guess = guess_sway(g, edit.density(), i, ties);
  return log_count(choices) - log_count(g.off(frame).size()) + TieChance(g, i).of(ties) +
         log_density(guess, sway);
}

// ---- one patch as two ----

/// What a split of v towards i can give away, in the state where they are one.
struct Shareable {
  std::size_t candidates = 0;  ///< that v could split towards
  std::vector<Index> edges;
  Index past = kNone;
};
Shareable shareable(const HiddenGraph& g, Index v, Index i) {
  Shareable result;
  for (const Beside& b : g.beside(v)) result.candidates += g.can_put(b.node) && g[b.node].kind == g[v].kind;
  for (const Index x : g[v].edges)
    if (gated(g, i, x)) result.edges.push_back(x);
  if (g[v].prev.size() == 1) {
    const Index p = g[v].prev[0];
    if (g.linkable(p, i) && !g[p].next.full()) result.past = p;
  }
  return result;
}
/// Chance of one way of sharing, after the choice of v.
double share_chance(const HiddenGraph& g, Index v, Index i) {
  const Shareable s = shareable(g, v, i);
  return std::exp2(-static_cast<double>(s.edges.size() + (s.past != kNone ? 1 : 0))) /
         static_cast<double>(s.candidates);
}
/// With i as the part of v: a node that could as well be the one it is part of, since one is left with the
/// same state without i. That is so where i lies between just two.
Index as_well(const HiddenGraph& g, Index v, Index i) {
  if (g[i].edges.size() != 2) return kNone;
  const Index u = g[i].edges[g[i].edges[0] == v ? 1 : 0];
  if (g[u].kind != g[i].kind || !gated(g, u, v) || g[u].edges.has(v)) return kNone;
  if (!g[i].prev.empty() && (g[u].prev.size() != 1 || g[u].prev[0] != g[i].prev[0])) return kNone;
  return u;
}

/// The sway of a part, by those that it is joined to in either case.
Guess guess_part(const HiddenGraph& g, const Density& density, Index v, Index i) {
  return {sense(g[i], g[v]) * g[v].sway, density.theta().sway.noise};
}

/// Chance of one way of sharing, and density of the sway.
double way_chance(const HiddenGraph& g, const Density& density, Index v, Index i, double sway) {
  return share_chance(g, v, i) * std::exp(log_density(guess_part(g, density, v, i), sway));
}

std::optional<double> split(Edit& edit, Draws& draws, int frame) {
  const HiddenGraph& g = edit.state();
  const std::size_t one = g.on(frame).size();
  if (one == 0) return std::nullopt;
  const Index v = g.on(frame)[draws.below(one)];
  std::vector<Index> candidates;
  for (const Beside& b : g.beside(v))
    if (g.can_put(b.node) && g[b.node].kind == g[v].kind) candidates.push_back(b.node);
  if (candidates.empty()) return std::nullopt;
  const Index i = candidates[draws.below(candidates.size())];
  const Shareable can = shareable(g, v, i);
  std::vector<Index> given;
  for (const Index x : can.edges)
    if (draws.coin()) given.push_back(x);
  const bool gives_past = can.past != kNone && draws.coin();
  const Guess guess = guess_part(g, edit.density(), v, i);
  const double sway = draws.normal(guess.mean, guess.sd);
  // Should it lie between two, it could as well have come from the other.
  double there = way_chance(g, edit.density(), v, i, sway);
  const double other = given.size() == 1 && g[given[0]].kind == g[v].kind
                           ? way_chance(g, edit.density(), given[0], i, sway)
                           : 0;
  edit.put(i);
  edit.set_sway(i, sway);
  for (const Index x : given) {
    edit.cut(v, x);
    edit.join(i, x);
  }
  if (!g.can_join(v, i)) {
    edit.undo();
    return std::nullopt;
  }
  edit.join(v, i);
  if (gives_past) edit.link(can.past, i);
  std::size_t into = 0;
  for (const Index x : g[i].edges) into += g[x].kind == g[i].kind;
  const bool two_ways = as_well(g, v, i) != kNone;
  if (two_ways) there += other;
  return log_count(one) - std::log(there) - log_count(g.on(frame).size()) + log_count(two_ways ? 2 : 1) -
         log_count(into);
}

std::optional<double> merge(Edit& edit, Draws& draws, int frame) {
  const HiddenGraph& g = edit.state();
  const std::size_t two = g.on(frame).size();
  if (two == 0) return std::nullopt;
  const Index i = g.on(frame)[draws.below(two)];
  std::vector<Index> into;
  for (const Index x : g[i].edges)
    if (g[x].kind == g[i].kind) into.push_back(x);
  if (into.empty()) return std::nullopt;
  const Index v = into[draws.below(into.size())];
  if (!g[i].next.empty() || g[i].prev.size() > 1) return std::nullopt;
  const Index past = g[i].prev.empty() ? kNone : g[i].prev[0];
  if (past != kNone && (g[v].prev.size() != 1 || g[v].prev[0] != past)) return std::nullopt;
  const Index other = as_well(g, v, i);
  std::vector<Index> given;
  for (const Index x : g[i].edges) {
    if (x == v) continue;
    if (!gated(g, v, x) || g[v].edges.has(x)) return std::nullopt;
    given.push_back(x);
  }
  const double sway = g[i].sway;
  if (past != kNone) edit.unlink(past, i);
  edit.cut(v, i);
  for (const Index x : given) {
    edit.cut(i, x);
    if (!g.can_join(v, x)) {
      edit.undo();
      return std::nullopt;
    }
    edit.join(v, x);
  }
  edit.take(i);
  double back = way_chance(g, edit.density(), v, i, sway);
  if (other != kNone) back += way_chance(g, edit.density(), other, i, sway);
  return log_count(two) + log_count(into.size()) - log_count(other != kNone ? 2 : 1) -
         log_count(g.on(frame).size()) + std::log(back);
}

}  // namespace

std::optional<double> connect_or_cut(Edit& edit, Draws& draws, int frame) {
  const HiddenGraph& g = edit.state();
  const bool connect = draws.coin();
  if (g.on(frame).empty()) return std::nullopt;
  const Index a = g.on(frame)[draws.below(g.on(frame).size())];
  // Either end may be the one that is drawn first.
  const auto either = [](std::size_t m, std::size_t n) {
    return log_count(m + n) - log_count(m) - log_count(n);
  };
  if (connect) {
    const std::size_t choices = joinable(g, a);
    if (choices == 0) return std::nullopt;
    std::size_t n = draws.below(choices);
    Index b = kNone;
    for (const Beside& near : g.beside(a))
      if (g.can_join(a, near.node) && n-- == 0) b = near.node;
    const double there = either(choices, joinable(g, b));
    edit.join(a, b);
    return either(g[a].edges.size(), g[b].edges.size()) - there;
  }
  if (g[a].edges.empty()) return std::nullopt;
  const Index b = g[a].edges[draws.below(g[a].edges.size())];
  const double there = either(g[a].edges.size(), g[b].edges.size());
  edit.cut(a, b);
  return either(joinable(g, a), joinable(g, b)) - there;
}

std::optional<double> add_or_delete(Edit& edit, Draws& draws, int frame) {
  return draws.coin() ? add(edit, draws, frame) : take(edit, draws, frame);
}

std::optional<double> split_or_merge(Edit& edit, Draws& draws, int frame) {
  return draws.coin() ? split(edit, draws, frame) : merge(edit, draws, frame);
}

}  // namespace emberfold::mcmc
