// SPDX-License-Identifier: Apache-2.0
#include "mcmc/edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace emberfold::mcmc {

void Scratch::fit(std::size_t nodes) {
  outcome.resize(nodes), arrival.resize(nodes), presence.resize(nodes), pairs.resize(nodes);
  outcome_values.resize(nodes), arrival_values.resize(nodes), presence_values.resize(nodes);
}

void Scratch::forget() {
  for (auto* values : {&outcome_values, &arrival_values, &presence_values})
    for (Value& value : *values) value.known = false;
}

Edit::Edit(HiddenGraph& g, const Density& density, Scratch& scratch, std::uint32_t who)
    : g_(g), density_(density), scratch_(scratch), stamp_((std::uint64_t{who} + 1) << 32U) {}

void Edit::begin() {
  if (!steps_.empty()) return;
  ++stamp_;
  outcomes_.clear(), arrivals_.clear(), presences_.clear(), paired_.clear(), pairs_.clear();
}

void Edit::note_outcome(Index v) {
  if (scratch_.outcome[v] == stamp_) return;
  scratch_.outcome[v] = stamp_;
  outcomes_.push_back(v);
}
void Edit::note_arrival(Index w) {
  if (scratch_.arrival[w] == stamp_) return;
  scratch_.arrival[w] = stamp_;
  arrivals_.push_back(w);
}
void Edit::note_presence(Index w) {
  if (scratch_.presence[w] == stamp_) return;
  scratch_.presence[w] = stamp_;
  presences_.push_back(w);
}
void Edit::note_new_beside(Index w) {
  for (const Beside& near : g_.beside(w))
    if (g_[near.node].on && g_[near.node].prev.empty()) note_arrival(near.node);
}
void Edit::note_pairs(Index w) {
  if (scratch_.pairs[w] == stamp_) return;
  scratch_.pairs[w] = stamp_;
  paired_.push_back(w);
}

void Edit::note_link(Index v, Index w) {
  const auto noted = [&](Index x) {
    note_outcome(x);
    // What could merge into x, and whoever is told what became of it.
    for (const Beside& near : g_.beside(x))
      if (near.closeness < 2 && g_[near.node].on && g_.before(x, near.node)) note_outcome(near.node);
    for (const Index y : g_[x].edges) note_outcome(y);
  };
  noted(v);
  for (const Index x : g_[w].prev) noted(x);
  note_arrival(w);
  for (const Index c : g_[v].next) note_arrival(c);
  for (const Index c : g_[w].next) note_arrival(c);
  note_new_beside(w);
  note_presence(w);
  note_pairs(w);
}

void Edit::note_edge(Index a, Index b) {
  for (const Index i : {a, b}) {
    note_outcome(i);
    if (g_[i].prev.empty()) note_arrival(i);
    for (const Index c : g_[i].next) {
      note_arrival(c);
      note_presence(c);
      note_new_beside(c);
    }
  }
  const auto add = [&](Index x, Index y) {
    if (x == y) return;
    const auto near = std::ranges::find(g_.beside(x), y, &Beside::node);
    if (near == g_.beside(x).end()) return;
    const Index first = std::min(x, y), second = std::max(x, y);
    const bool known = std::ranges::any_of(
        pairs_, [&](const auto& p) { return p.first == first && p.second.node == second; });
    if (!known) pairs_.emplace_back(first, Beside{second, near->closeness, near->evidence});
  };
  const auto add_next = [&](Index x, Index y) {
    for (const Index c : g_[x].next)
      for (const Index d : g_[y].next) add(c, d);
  };
  add(a, b);
  add_next(a, b);
  for (const Index x : g_[a].edges)
    if (x != b) add_next(x, b);
  for (const Index y : g_[b].edges)
    if (y != a) add_next(a, y);
}

void Edit::note_lone(Index i) {
  note_outcome(i);
  note_arrival(i);
  note_presence(i);
  note_new_beside(i);
}

double Edit::pairs_sum() const {
  double sum = 0;
  const auto paired = [&](Index i) { return scratch_.pairs[i] == stamp_; };
  for (const Index w : paired_)
    for (const Beside& near : g_.beside(w))
      if (!paired(near.node) || w < near.node) sum += density_.of_pair(g_, w, near);
  for (const auto& [a, b] : pairs_)
    if (!paired(a) && !paired(b.node)) sum += density_.of_pair(g_, a, b);
  return sum;
}

double Edit::sum() {
  double sum = 0;
  for (const Index v : outcomes_)
    if (g_[v].on) sum += density_.of_outcome(g_, v);
  for (const Index w : arrivals_)
    if (g_[w].on) sum += density_.of_arrival(g_, w);
  for (const Index w : presences_)
    if (g_[w].on) sum += density_.of_presence(g_, w);
  return sum + pairs_sum();
}

// The same where nothing is changed: what is known of it is not evaluated again.
double Edit::kept_sum() {
  double sum = 0;
  const auto add = [&](Scratch::Value& value, auto&& evaluate) {
    if (!value.known || !scratch_.remembers) value = {evaluate(), true};
    sum += value.value;
  };
  for (const Index v : outcomes_)
    if (g_[v].on) add(scratch_.outcome_values[v], [&] { return density_.of_outcome(g_, v); });
  for (const Index w : arrivals_)
    if (g_[w].on) add(scratch_.arrival_values[w], [&] { return density_.of_arrival(g_, w); });
  for (const Index w : presences_)
    if (g_[w].on) add(scratch_.presence_values[w], [&] { return density_.of_presence(g_, w); });
  return sum + pairs_sum();
}

double Edit::gain() {
  constexpr double kImpossible = -std::numeric_limits<double>::infinity();
  if (steps_.empty()) return 0;
  const double is = sum();
  if (is == kImpossible) return kImpossible;
  for (std::size_t k = steps_.size(); k-- > 0;) take_back(steps_[k]);
  const double was = kept_sum();
  for (Step& step : steps_) take_again(step);
  return is - was + edges_;
}

double Edit::edge_evidence(Index a, Index b) const {
  const auto near = std::ranges::find(g_.beside(a), b, &Beside::node);
  return near == g_.beside(a).end() ? 0 : density_.of_edge(*near);
}

void Edit::add(const Step& step) {
  steps_.push_back(step);
  take_again(steps_.back());
}

void Edit::link(Index v, Index w) {
  begin();
  note_link(v, w);
  add({What::link, v, w, {}, 0});
}
void Edit::unlink(Index v, Index w) {
  begin();
  note_link(v, w);
  add({What::unlink, v, w, {}, 0});
}
void Edit::join(Index a, Index b) {
  begin();
  note_edge(a, b);
  edges_ += edge_evidence(a, b);
  add({What::join, a, b, {}, 0});
}
void Edit::cut(Index a, Index b) {
  begin();
  note_edge(a, b);
  edges_ -= edge_evidence(a, b);
  add({What::cut, a, b, {}, 0});
}
void Edit::put(Index i) {
  begin();
  note_lone(i);
  add({What::put, i, 0, {}, 0});
}
void Edit::take(Index i) {
  begin();
  note_lone(i);
  add({What::take, i, 0, {}, 0});
}
void Edit::set_sway(Index i, double sway) {
  begin();
  note_arrival(i);
  for (const Index c : g_[i].next) {
    note_arrival(c);
    for (const Index d : g_[c].next) note_arrival(d);
  }
  for (const Index x : g_[i].edges)
    for (const Index c : g_[x].next) note_arrival(c);
  add({What::sway, i, 0, {}, sway});
}

void Edit::take_again(Step& s) {
  switch (s.what) {
    case What::link:
      g_.link(s.a, s.b);
      break;
    case What::unlink:
      s.at = g_.unlink(s.a, s.b);
      break;
    case What::join:
      g_.join(s.a, s.b);
      break;
    case What::cut:
      s.at = g_.cut(s.a, s.b);
      break;
    case What::put:
      s.at = g_.off_place(s.a);
      g_.put(s.a);
      break;
    case What::take:
      s.at = g_.take(s.a);
      break;
    case What::sway: {
      const double was = g_[s.a].sway;
      g_.set_sway(s.a, s.sway);
      s.sway = was;
      break;
    }
  }
}

void Edit::take_back(Step& s) {
  switch (s.what) {
    case What::link:
      g_.unlink(s.a, s.b);
      break;
    case What::unlink:
      g_.undo_unlink(s.a, s.b, s.at);
      break;
    case What::join:
      g_.cut(s.a, s.b);
      break;
    case What::cut:
      g_.undo_cut(s.a, s.b, s.at);
      break;
    case What::put:
      g_.undo_put(s.a, s.at);
      break;
    case What::take:
      g_.undo_take(s.a, s.at);
      break;
    case What::sway:
      take_again(s);  // changes places with what is there
      break;
  }
}

void Edit::keep() {
  if (!steps_.empty()) {
    for (const Index v : outcomes_) scratch_.outcome_values[v].known = false;
    for (const Index w : arrivals_) scratch_.arrival_values[w].known = false;
    for (const Index w : presences_) scratch_.presence_values[w].known = false;
  }
  steps_.clear();
  edges_ = 0;
}

void Edit::undo() {
  for (; !steps_.empty(); steps_.pop_back()) take_back(steps_.back());
  edges_ = 0;
}

}  // namespace emberfold::mcmc
