// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

constexpr std::size_t kLongestRun = 64, kLargestStroke = 160;

/// Links seen from the frame after (`back`) or from the one before.
struct Side {
  const HiddenGraph& g;
  bool back;

  /// Returns the only partner of i, which has no other partner; or none.
  [[nodiscard]] Index partner(Index i) const {
    const auto& mine = back ? g[i].prev : g[i].next;
    if (mine.size() != 1) return kNone;
    return (back ? g[mine[0]].next : g[mine[0]].prev).size() == 1 ? mine[0] : kNone;
  }
  [[nodiscard]] bool is_free(Index i) const { return (back ? g[i].prev : g[i].next).empty(); }
  [[nodiscard]] bool gated(Index i, Index partner) const {
    return back ? g.linkable(partner, i) : g.linkable(i, partner);
  }
  void link(StateChange& change, Index i, Index partner) const {
    back ? change.link(partner, i) : change.link(i, partner);
  }
  void unlink(StateChange& change, Index i, Index partner) const {
    back ? change.unlink(partner, i) : change.unlink(i, partner);
  }
};

/// Patches after the first of a run: it starts at a free patch and follows its curve as long as each patch's
/// partner lies beside the last one's.
std::vector<Index> run_from(const Side& side, Index first, Index second) {
  std::vector<Index> run;
  Index last = first, i = second, before = kNone;
  while (run.size() < kLongestRun) {
    const Index partner = side.partner(i);
    if (partner == kNone || (before != kNone && !side.g[before].edges.has(partner))) break;
    run.push_back(i);
    if (side.g[i].edges.size() != 2) break;
    const Index next = side.g[i].edges[side.g[i].edges[0] == last ? 1 : 0];
    last = i, i = next, before = partner;
    if (i == first) break;
  }
  return run;
}

std::vector<Index> component(const HiddenGraph& g, Index i) {
  std::vector<Index> found{i};
  for (std::size_t k = 0; k < found.size() && found.size() <= kLargestStroke; ++k)
    for (const Index j : g[found[k]].edges)
      if (std::ranges::find(found, j) == found.end()) found.push_back(j);
  if (found.size() > kLargestStroke) found.clear();
  return found;
}

using Pairs = std::vector<std::pair<Index, Index>>;

/// Pairs of patches of two strokes, nearest first, each patch once. They depend on places alone.
Pairs match_patches(const HiddenGraph& g, const std::vector<Index>& before, const std::vector<Index>& after) {
  std::vector<std::tuple<double, Index, Index>> near;
  for (const Index v : before)
    for (std::size_t k = 0; k < g.candidates_after(v).size(); ++k) {
      const Index w = g.candidates_after(v)[k];
      if (!g.is_active(w) || std::ranges::find(after, w) == after.end()) continue;
      const TransitionOffset& offset = g.offsets(v)[k];
      near.emplace_back(offset.across * offset.across + offset.along * offset.along, v, w);
    }
  std::ranges::sort(near);
  Pairs pairs;
  for (const auto& entry : near) {
    const Index v = std::get<1>(entry), w = std::get<2>(entry);
    if (std::ranges::none_of(pairs, [&](const auto& p) { return p.first == v || p.second == w; }))
      pairs.emplace_back(v, w);
  }
  return pairs;
}

bool are_linked(const HiddenGraph& g, const Pairs& pairs) {
  return std::ranges::all_of(pairs, [&](const auto& p) {
    return g[p.first].next.size() == 1 && g[p.first].next[0] == p.second && g[p.second].prev.size() == 1;
  });
}

}  // namespace

std::optional<double> shift_links(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const Side side{g, draws.coin()};
  const auto shown = g.active(side.back ? frame + 1 : frame);
  if (shown.empty()) return std::nullopt;
  const Index first = shown[draws.below(shown.size())];
  if (!side.is_free(first) || g[first].edges.empty()) return std::nullopt;
  const Index second = g[first].edges[draws.below(g[first].edges.size())];
  auto run = run_from(side, first, second);
  if (run.empty()) return std::nullopt;
  const double here = std::log(static_cast<double>(g[first].edges.size() * run.size()));
  run.resize(1 + draws.below(run.size()));
  Index to = first;
  for (const Index i : run) {
    const Index partner = side.partner(i);
    if (!side.gated(to, partner)) {
      change.rollback();
      return std::nullopt;
    }
    side.unlink(change, i, partner);
    side.link(change, to, partner);
    to = i;
  }
  const Index last = run.back(), before = run.size() > 1 ? run[run.size() - 2] : first;
  const auto back = run_from(side, last, before);
  return here - std::log(static_cast<double>(g[last].edges.size() * back.size()));
}

std::optional<double> link_strokes(StateChange& change, ChoiceSource& draws, int frame) {
  // The drawn strokes and their pairs do not depend on links.
  const HiddenGraph& g = change.state();
  if (g.active(frame).empty()) return std::nullopt;
  const Index v = g.active(frame)[draws.below(g.active(frame).size())];
  if (g.candidates_after(v).empty()) return std::nullopt;
  const Index w = g.candidates_after(v)[draws.below(g.candidates_after(v).size())];
  if (!g.is_active(w)) return std::nullopt;
  const Pairs pairs = match_patches(g, component(g, v), component(g, w));
  if (pairs.empty()) return std::nullopt;
  if (are_linked(g, pairs)) {
    for (const auto& [a, b] : pairs) change.unlink(a, b);
    return 0;
  }
  for (const auto& [a, b] : pairs)
    if (!g[a].next.empty() || !g[b].prev.empty()) return std::nullopt;
  for (const auto& [a, b] : pairs) change.link(a, b);
  return 0;
}

std::optional<double> relink_stroke(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  if (g.active(frame + 1).empty()) return std::nullopt;
  const Index w = g.active(frame + 1)[draws.below(g.active(frame + 1).size())];
  const auto behind = g.candidates_before(w);
  if (behind.empty()) return std::nullopt;
  const Index a = behind[draws.below(behind.size())], b = behind[draws.below(behind.size())];
  if (!g[a].active || !g[b].active) return std::nullopt;
  const auto from = component(g, a), to = component(g, b), stroke = component(g, w);
  if (std::ranges::find(from, b) != from.end()) return std::nullopt;
  const Pairs was = match_patches(g, from, stroke), is = match_patches(g, to, stroke);
  if (was.empty() || is.empty() || !are_linked(g, was)) return std::nullopt;
  for (const auto& [v, x] : is) {
    const bool freed = std::ranges::any_of(was, [x = x](const auto& p) { return p.second == x; });
    if (!g[v].next.empty() || (!freed && !g[x].prev.empty())) return std::nullopt;
  }
  for (const auto& [v, x] : was) change.unlink(v, x);
  for (const auto& [v, x] : is) change.link(v, x);
  return 0;
}

}  // namespace emberfold::mcmc
