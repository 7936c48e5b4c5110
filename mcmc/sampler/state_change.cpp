// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/state_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace emberfold::mcmc {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void Scratch::remember(const HiddenGraph& g) {
  fit(g.size());
  remembers_ = true;
  first_.clear();
  std::size_t pairs = 0;
  for (Index i = 0; i < g.size(); ++i) {
    first_.push_back(pairs);
    pairs += g.beside(i).size();
  }
  pairs_.assign(pairs, kUnknown);
  forget();
}

void Scratch::forget() {
  for (Mark& mark : marks_) mark.known = 0;
  std::ranges::fill(pairs_, kUnknown);
}

void Scratch::forget_arrivals() {
  for (Mark& mark : marks_) mark.known = static_cast<std::uint8_t>(mark.known & ~kArrival);
}

Edit::Edit(HiddenGraph& g, const Density& density, Scratch& scratch, std::uint32_t who)
    : g_(g), density_(density), scratch_(scratch), stamp_((std::uint64_t{who} + 1) << 32U) {}

// ---- what each step touches ----

void Edit::begin() {
  if (!steps_.empty()) return;
  ++stamp_;
  outcomes_.clear(), arrivals_.clear(), presences_.clear(), paired_.clear(), pairs_.clear();
}

bool Edit::note(Index i, Factor factor) {
  auto& mark = scratch_.marks_[i];
  if (mark.stamp != stamp_) mark.stamp = stamp_, mark.noted = 0;
  if ((mark.noted & factor) != 0) return false;
  mark.noted = static_cast<std::uint8_t>(mark.noted | factor);
  return true;
}
void Edit::note_outcome(Index v) {
  if (note(v, Scratch::kOutcome)) outcomes_.push_back(v);
}
void Edit::note_arrival(Index w) {
  if (note(w, Scratch::kArrival)) arrivals_.push_back(w);
}
void Edit::note_presence(Index w) {
  if (note(w, Scratch::kPresence)) presences_.push_back(w);
}

// What becomes of x changes; `dies`: whether it dies does.
void Edit::note_outcomes_about(Index x, bool dies) {
  note_outcome(x);
  for (const Index guest : g_.guests(x))
    if (g_.is_on(guest)) note_outcome(guest);
  if (dies)
    for (const Index y : g_[x].edges) note_outcome(y);
}

// The rate at which others grow from w changes.
void Edit::note_grown_from(Index w) {
  note_presence(w);
  for (const Index x : g_[w].edges)
    if (!g_.has_past(x)) note_arrival(x);
}

// `last`: v has no other link, so that it dies with this or without it.
void Edit::note_link(Index v, Index w, bool last) {
  const Node &from = g_[v], &to = g_[w];
  note_outcomes_about(v, last);
  note_arrival(w);
  for (const Index x : to.prev)
    if (x != v) note_outcomes_about(x, false);
  for (const Index c : from.next) note_arrival(c);
  for (const Index c : to.next) note_arrival(c);
  note_grown_from(w);
  // Whether w is new, or not, is for those to know that come before it.
  if (to.prev.size() <= 1)
    for (const Beside& near : g_.beside(w))
      if (near.earlier && g_.is_on(near.node) && !g_.has_past(near.node)) note_arrival(near.node);
  if (note(w, Scratch::kPairs)) paired_.push_back(w);
}

void Edit::note_pair(Index a, Index b) {
  if (a == b || !g_.has_past(a) || !g_.has_past(b)) return;
  const Index first = std::min(a, b), second = std::max(a, b);
  const auto beside = g_.beside(first);
  const auto near = std::ranges::find(beside, second, &Beside::node);
  if (near == beside.end()) return;
  const auto place = static_cast<std::size_t>(near - beside.begin());
  if (std::ranges::none_of(pairs_, [&](const Pair& p) { return p.node == first && p.beside == place; }))
    pairs_.push_back({first, place});
}

void Edit::note_edge(Index a, Index b) {
  const bool coupled = density_.theta().sway.coupling != 0;
  for (const Index i : {a, b}) {
    note_outcome(i);
    if (!g_.has_past(i)) note_arrival(i);
    for (const Index c : g_[i].next) {
      if (coupled) note_arrival(c);
      note_grown_from(c);
    }
  }
  const auto note_next = [&](Index x, Index y) {
    for (const Index c : g_[x].next)
      for (const Index d : g_[y].next) note_pair(c, d);
  };
  note_pair(a, b);
  note_next(a, b);
  for (const Index x : g_[a].edges)
    if (x != b) note_next(x, b);
  for (const Index y : g_[b].edges)
    if (y != a) note_next(a, y);
}

void Edit::note_lone(Index i) {
  note_outcome(i);
  note_arrival(i);
  note_presence(i);
  for (const Beside& near : g_.beside(i))
    if (!near.earlier && g_.is_on(near.node) && !g_.has_past(near.node)) note_arrival(near.node);
}

// ---- what the factors are ----

// All noted pairs, each once.
template <class Visit>
void Edit::visit_pairs(Visit visit) const {
  const auto paired = [&](Index x) {  // few are: to look through them is quicker than to look x up
    return paired_.size() <= 4 ? std::ranges::find(paired_, x) != paired_.end() : noted(x, Scratch::kPairs);
  };
  for (const Index w : paired_) {
    const auto beside = g_.beside(w);
    for (std::size_t k = 0; k < beside.size(); ++k)
      if (w < beside[k].node || !paired(beside[k].node)) visit(w, k);
  }
  for (const Pair& p : pairs_)
    if (!paired(p.node) && !paired(g_.beside(p.node)[p.beside].node)) visit(p.node, p.beside);
}

double Edit::sum() const {
  double sum = 0;
  for (const Index v : outcomes_)
    if (g_.is_on(v)) sum += density_.of_outcome(g_, v);
  for (const Index w : arrivals_)
    if (g_.is_on(w)) sum += density_.of_arrival(g_, w);
  for (const Index w : presences_)
    if (g_.is_on(w)) sum += density_.of_presence(g_, w);
  visit_pairs([&](Index w, std::size_t k) { sum += density_.of_pair(g_, w, g_.beside(w)[k]); });
  return sum;
}

// The sum in the state before, of which all factors must be known.
std::optional<double> Edit::known_sum() const {
  if (!scratch_.remembers_) return std::nullopt;
  double sum = 0;
  bool known = true;
  const auto add = [&](const std::vector<Index>& list, Factor factor, double Scratch::Mark::*value) {
    for (const Index i : list) {
      const auto& mark = scratch_.marks_[i];
      known = known && (mark.known & factor) != 0;
      sum += mark.*value;
    }
  };
  add(outcomes_, Scratch::kOutcome, &Scratch::Mark::outcome);
  add(arrivals_, Scratch::kArrival, &Scratch::Mark::arrival);
  add(presences_, Scratch::kPresence, &Scratch::Mark::presence);
  if (!known) return std::nullopt;
  visit_pairs([&](Index w, std::size_t k) { sum += scratch_.pairs_[scratch_.first_[w] + k]; });
  return std::isnan(sum) ? std::nullopt : std::optional(sum);
}

// The same once the state before is there again. What is not known is evaluated, and kept.
double Edit::former_sum() {
  double sum = 0;
  const auto add = [&](const std::vector<Index>& list, Factor factor, double Scratch::Mark::*value,
                       auto&& evaluate) {
    for (const Index i : list) {
      auto& mark = scratch_.marks_[i];
      if (!scratch_.remembers_ || (mark.known & factor) == 0) {
        mark.*value = g_.is_on(i) ? evaluate(i) : 0;
        mark.known = static_cast<std::uint8_t>(mark.known | factor);
      }
      sum += mark.*value;
    }
  };
  add(outcomes_, Scratch::kOutcome, &Scratch::Mark::outcome,
      [&](Index v) { return density_.of_outcome(g_, v); });
  add(arrivals_, Scratch::kArrival, &Scratch::Mark::arrival,
      [&](Index w) { return density_.of_arrival(g_, w); });
  add(presences_, Scratch::kPresence, &Scratch::Mark::presence,
      [&](Index w) { return density_.of_presence(g_, w); });
  visit_pairs([&](Index w, std::size_t k) {
    double* kept = scratch_.remembers_ ? &scratch_.pairs_[scratch_.first_[w] + k] : nullptr;
    const double value =
        kept != nullptr && !std::isnan(*kept) ? *kept : density_.of_pair(g_, w, g_.beside(w)[k]);
    if (kept != nullptr) *kept = value;
    sum += value;
  });
  return sum;
}

// Whether the factors as they are now may sum to `need`: they are evaluated as long as those that are left
// could still make up for what is missing.
bool Edit::may_reach(double need) const {
  const double enough = need - 1e-9 * (1 + std::abs(need));  // rounding decides nothing
  double most = 0;
  for (const Index w : presences_)
    if (g_.is_on(w)) most += density_.of_presence(g_, w);
  for (const Index v : outcomes_)
    if (g_.is_on(v)) most += density_.most_of_outcome();
  for (const Index w : arrivals_)
    if (g_.is_on(w)) most += density_.most_of_arrival(g_, w);
  if (most < enough) return false;
  for (std::size_t k = 0; k < std::max(arrivals_.size(), outcomes_.size()); ++k) {
    if (k < arrivals_.size() && g_.is_on(arrivals_[k]))
      most += density_.of_arrival(g_, arrivals_[k]) - density_.most_of_arrival(g_, arrivals_[k]);
    if (k < outcomes_.size() && g_.is_on(outcomes_[k]))
      most += density_.of_outcome(g_, outcomes_[k]) - density_.most_of_outcome();
    if (most < enough) return false;
  }
  visit_pairs([&](Index w, std::size_t k) {
    if (most >= enough) most += density_.of_pair(g_, w, g_.beside(w)[k]);
  });
  return most >= enough;
}

double Edit::gain(double least) {
  constexpr double kImpossible = -std::numeric_limits<double>::infinity();
  if (steps_.empty()) return 0;
  auto was = known_sum();
  if (!was) {
    for (std::size_t k = steps_.size(); k-- > 0;) take_back(steps_[k]);
    was = former_sum();
    for (Step& step : steps_) take_again(step);
  }
  if (least > kImpossible && !may_reach(least + *was - edges_)) return kImpossible;
  const double is = sum();
  return is == kImpossible ? kImpossible : is - *was + edges_;
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
  note_link(v, w, g_[v].next.empty());
  add({What::link, v, w, {}, 0});
}
void Edit::unlink(Index v, Index w) {
  begin();
  note_link(v, w, g_[v].next.size() == 1);
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
  if (density_.theta().sway.coupling != 0)
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

void Edit::forget_noted() {
  const auto forget = [&](const std::vector<Index>& list, Factor factor) {
    for (const Index i : list) {
      auto& mark = scratch_.marks_[i];
      mark.known = static_cast<std::uint8_t>(mark.known & ~factor);
    }
  };
  forget(outcomes_, Scratch::kOutcome);
  forget(arrivals_, Scratch::kArrival);
  forget(presences_, Scratch::kPresence);
  visit_pairs([&](Index w, std::size_t k) {
    const Index x = g_.beside(w)[k].node;
    const auto back = std::ranges::find(g_.beside(x), w, &Beside::node) - g_.beside(x).begin();
    scratch_.pairs_[scratch_.first_[w] + k] = kUnknown;
    scratch_.pairs_[scratch_.first_[x] + static_cast<std::size_t>(back)] = kUnknown;
  });
}

void Edit::keep() {
  if (!steps_.empty() && scratch_.remembers_) forget_noted();
  steps_.clear();
  edges_ = 0;
}

void Edit::undo() {
  for (; !steps_.empty(); steps_.pop_back()) take_back(steps_.back());
  edges_ = 0;
}

}  // namespace emberfold::mcmc
