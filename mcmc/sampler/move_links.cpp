// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/choose.hpp"
#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

Index any_of(std::span<const Index> list, Draws& draws) {
  return list.empty() ? kNone : list[draws.below(list.size())];
}

}  // namespace

std::optional<double> link_or_unlink(Edit& edit, Draws& draws, int frame) {
  const HiddenGraph& g = edit.state();
  const bool link = draws.coin();
  const Index v = any_of(g.on(frame), draws);
  if (v == kNone) return std::nullopt;
  const auto linkable = [&](Index w) { return g.can_link(v, w); };
  if (link) {
    const std::size_t choices = count_if(g.ahead(v), linkable);
    if (choices == 0) return std::nullopt;
    edit.link(v, nth(g.ahead(v), draws.below(choices), linkable));
    return log_count(choices) - log_count(g[v].next.size());
  }
  const std::size_t links = g[v].next.size();
  if (links == 0) return std::nullopt;
  edit.unlink(v, g[v].next[draws.below(links)]);
  return log_count(links) - log_count(count_if(g.ahead(v), linkable));
}

std::optional<double> switch_links(Edit& edit, Draws& draws, int frame) {
  // Both chances, here and there, are made of the same counts: links a patch has, neighbours it could have.
  const HiddenGraph& g = edit.state();
  const Index a = any_of(g.on(frame), draws);
  if (a == kNone || g[a].next.empty() || g.beside(a).empty()) return std::nullopt;
  const Index c = g.beside(a)[draws.below(g.beside(a).size())].node;
  if (!g[c].on || g[c].next.empty() || g[c].kind != g[a].kind) return std::nullopt;
  const Index b = g[a].next[draws.below(g[a].next.size())];
  const Index d = g[c].next[draws.below(g[c].next.size())];
  if (b == d || !g.linkable(a, d) || !g.linkable(c, b)) return std::nullopt;
  edit.unlink(a, b);
  edit.unlink(c, d);
  if (g.can_link(a, d)) {
    edit.link(a, d);
    if (g.can_link(c, b)) {
      edit.link(c, b);
      return 0;
    }
  }
  edit.undo();
  return std::nullopt;
}

std::optional<double> relink(Edit& edit, Draws& draws, int frame) {
  // Without the link, the choices are the same from either of its places.
  const HiddenGraph& g = edit.state();
  const bool forward = draws.coin();
  const Index i = any_of(g.on(forward ? frame : frame + 1), draws);
  if (i == kNone) return std::nullopt;
  const auto& links = forward ? g[i].next : g[i].prev;
  if (links.empty()) return std::nullopt;
  const Index was = links[draws.below(links.size())];
  forward ? edit.unlink(i, was) : edit.unlink(was, i);
  const auto other = [&](Index j) { return j != was && (forward ? g.can_link(i, j) : g.can_link(j, i)); };
  const std::size_t choices = forward ? count_if(g.ahead(i), other) : count_if(g.behind(i), other);
  if (choices == 0) {
    edit.undo();
    return std::nullopt;
  }
  const std::size_t n = draws.below(choices);
  const Index is = forward ? nth(g.ahead(i), n, other) : nth(g.behind(i), n, other);
  forward ? edit.link(i, is) : edit.link(is, i);
  return 0;
}

}  // namespace emberfold::mcmc
