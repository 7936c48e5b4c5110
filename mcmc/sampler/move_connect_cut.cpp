// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

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

}  // namespace emberfold::mcmc
