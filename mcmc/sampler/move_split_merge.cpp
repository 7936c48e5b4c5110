// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "mcmc/sampler/choose.hpp"
#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

bool are_neighbours(const HiddenGraph& g, Index a, Index b) {
  return std::ranges::find(g.neighbours(a), b, &NeighbourCandidate::node) != g.neighbours(a).end();
}

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
NormalProposal propose_part_displacement(const HiddenGraph& g, const Density& density, Index v, Index i) {
  return {sense(g[i], g[v]) * g[v].displacement, density.theta().displacement.noise};
}

/// Probability of one way of sharing times the density of the displacement.
double way_chance(const HiddenGraph& g, const Density& density, Index v, Index i, double displacement) {
  return share_chance(g, v, i) *
         std::exp(propose_part_displacement(g, density, v, i).log_density(displacement));
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
  const NormalProposal proposal = propose_part_displacement(g, change.density(), v, i);
  const double displacement = draws.normal(proposal.mean, proposal.sd);
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

std::optional<double> split_or_merge(StateChange& change, ChoiceSource& draws, int frame) {
  return draws.coin() ? split_patch(change, draws, frame) : merge_patches(change, draws, frame);
}

}  // namespace emberfold::mcmc
