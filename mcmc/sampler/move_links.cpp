// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/choose.hpp"
#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

Index draw_any(std::span<const Index> list, ChoiceSource& draws) {
  return list.empty() ? kNone : list[draws.below(list.size())];
}

}  // namespace

std::optional<double> link_or_unlink(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const bool link = draws.coin();
  const Index v = draw_any(g.active(frame), draws);
  if (v == kNone) return std::nullopt;
  const auto linkable = [&](Index w) { return g.can_link(v, w); };
  if (link) {
    const std::size_t choices = count_if(g.candidates_after(v), linkable);
    if (choices == 0) return std::nullopt;
    change.link(v, nth(g.candidates_after(v), draws.below(choices), linkable));
    return log_count(choices) - log_count(g[v].next.size());
  }
  const std::size_t links = g[v].next.size();
  if (links == 0) return std::nullopt;
  change.unlink(v, g[v].next[draws.below(links)]);
  return log_count(links) - log_count(count_if(g.candidates_after(v), linkable));
}

std::optional<double> switch_links(StateChange& change, ChoiceSource& draws, int frame) {
  // Both probabilities, forwards and backwards, depend on the same counts: links of a patch, possible
  // neighbours.
  const HiddenGraph& g = change.state();
  const Index a = draw_any(g.active(frame), draws);
  if (a == kNone || g[a].next.empty() || g.neighbours(a).empty()) return std::nullopt;
  const Index c = g.neighbours(a)[draws.below(g.neighbours(a).size())].node;
  if (!g[c].active || g[c].next.empty() || g[c].kind != g[a].kind) return std::nullopt;
  const Index b = g[a].next[draws.below(g[a].next.size())];
  const Index d = g[c].next[draws.below(g[c].next.size())];
  if (b == d || !g.linkable(a, d) || !g.linkable(c, b)) return std::nullopt;
  change.unlink(a, b);
  change.unlink(c, d);
  if (g.can_link(a, d)) {
    change.link(a, d);
    if (g.can_link(c, b)) {
      change.link(c, b);
      return 0;
    }
  }
  change.rollback();
  return std::nullopt;
}

std::optional<double> relink(StateChange& change, ChoiceSource& draws, int frame) {
  // Without the link, the choices are the same from both of its places.
  const HiddenGraph& g = change.state();
  const bool forward = draws.coin();
  const Index i = draw_any(g.active(forward ? frame : frame + 1), draws);
  if (i == kNone) return std::nullopt;
  const auto& links = forward ? g[i].next : g[i].prev;
  if (links.empty()) return std::nullopt;
  const Index was = links[draws.below(links.size())];
  forward ? change.unlink(i, was) : change.unlink(was, i);
  const auto other = [&](Index j) { return j != was && (forward ? g.can_link(i, j) : g.can_link(j, i)); };
  const std::size_t choices =
      forward ? count_if(g.candidates_after(i), other) : count_if(g.candidates_before(i), other);
  if (choices == 0) {
    change.rollback();
    return std::nullopt;
  }
  const std::size_t n = draws.below(choices);
  const Index is = forward ? nth(g.candidates_after(i), n, other) : nth(g.candidates_before(i), n, other);
  forward ? change.link(i, is) : change.link(is, i);
  return 0;
}

}  // namespace emberfold::mcmc
