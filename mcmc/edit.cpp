// SPDX-License-Identifier: Apache-2.0
#include "mcmc/edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace emberfold::mcmc {

void Scratch::fit(std::size_t nodes) {
  outcome.resize(nodes), arrival.resize(nodes), presence.resize(nodes);
}

Edit::Edit(HiddenGraph& g, const Density& density, Scratch& scratch, std::uint32_t who)
    : g_(g), density_(density), scratch_(scratch), stamp_((std::uint64_t{who} + 1) << 40U) {}

void Edit::begin() {
  ++stamp_;
  outcomes_.clear(), arrivals_.clear(), presences_.clear(), pairs_.clear();
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
  for (const Beside& near : g_.beside(w))
    if (g_[near.node].on && !g_[near.node].prev.empty()) pairs_.emplace_back(w, near);
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
    const bool known = std::ranges::any_of(pairs_, [&](const auto& p) {
      return (p.first == x && p.second.node == y) || (p.first == y && p.second.node == x);
    });
    if (!known) pairs_.emplace_back(x, *near);
  };
  add(a, b);
  for (const Index c : g_[a].next)
    for (const Index d : g_[b].next) add(c, d);
}

void Edit::note_lone(Index i) {
  note_outcome(i);
  note_arrival(i);
  note_presence(i);
  note_new_beside(i);
}

Edit::Sum Edit::sum() const {
  Sum sum;
  const auto add = [&](double term) {
    if (term == -std::numeric_limits<double>::infinity())
      ++sum.impossible;
    else
      sum.finite += term;
  };
  for (const Index v : outcomes_)
    if (g_[v].on) add(density_.of_outcome(g_, v));
  for (const Index w : arrivals_)
    if (g_[w].on) add(density_.of_arrival(g_, w));
  for (const Index w : presences_)
    if (g_[w].on) add(density_.of_presence(g_, w));
  for (const auto& [a, b] : pairs_) add(density_.of_pair(g_, a, b));
  return sum;
}

double Edit::gain() const {
  constexpr double never = std::numeric_limits<double>::infinity();
  return impossible_ == 0 ? gain_ : impossible_ > 0 ? -never : never;
}

template <class Note, class Change>
void Edit::step(Note note, Change change) {
  begin();
  note();
  const Sum was = sum();
  steps_.push_back(change());
  const Sum is = sum();
  gain_ += is.finite - was.finite;
  impossible_ += is.impossible - was.impossible;
}

void Edit::link(Index v, Index w) {
  step([&] { note_link(v, w); },
       [&] {
         g_.link(v, w);
         return Step{What::link, v, w, {}, 0};
       });
}
void Edit::unlink(Index v, Index w) {
  step([&] { note_link(v, w); }, [&] { return Step{What::unlink, v, w, g_.unlink(v, w), 0}; });
}
void Edit::join(Index a, Index b) {
  step([&] { note_edge(a, b); },
       [&] {
         g_.join(a, b);
         return Step{What::join, a, b, {}, 0};
       });
}
void Edit::cut(Index a, Index b) {
  step([&] { note_edge(a, b); }, [&] { return Step{What::cut, a, b, g_.cut(a, b), 0}; });
}
void Edit::put(Index i) {
  step([&] { note_lone(i); },
       [&] {
         const auto at = g_.off_place(i);
         g_.put(i);
         return Step{What::put, i, 0, at, 0};
       });
}
void Edit::take(Index i) {
  step([&] { note_lone(i); }, [&] { return Step{What::take, i, 0, g_.take(i), 0}; });
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
  const auto sways = [&] {
    double sum = 0;
    for (const Index w : arrivals_) {
      // An arrival that cannot be is counted, and comes with its sway once it can.
      const bool may_not = g_[w].log_birth == -std::numeric_limits<double>::infinity();
      if (may_not && density_.of_arrival(g_, w) == -std::numeric_limits<double>::infinity()) continue;
      sum += density_.of_sway(g_, w);
    }
    return sum;
  };
  const double was = sways();
  steps_.push_back({What::sway, i, 0, {}, g_[i].sway});
  g_.set_sway(i, sway);
  gain_ += sways() - was;
}

void Edit::keep() {
  steps_.clear();
  gain_ = 0, impossible_ = 0;
}

void Edit::undo() {
  for (; !steps_.empty(); steps_.pop_back()) {
    const Step& s = steps_.back();
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
        g_.set_sway(s.a, s.sway);
        break;
    }
  }
  gain_ = 0, impossible_ = 0;
}

}  // namespace emberfold::mcmc
