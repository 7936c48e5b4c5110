// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/state_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace emberfold::mcmc {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void FactorCache::enable(const HiddenGraph& g) {
  resize(g.size());
  enabled_ = true;
  first_.clear();
  std::size_t pairs = 0;
  for (Index i = 0; i < g.size(); ++i) {
    first_.push_back(pairs);
    pairs += g.neighbours(i).size();
  }
  pairs_.assign(pairs, kUnknown);
  invalidate();
}

void FactorCache::invalidate() {
  for (Mark& mark : marks_) mark.known = 0;
  std::ranges::fill(pairs_, kUnknown);
}

void FactorCache::invalidate_arrivals() {
  for (Mark& mark : marks_) mark.known = static_cast<std::uint8_t>(mark.known & ~kArrival);
}

StateChange::StateChange(HiddenGraph& g, const Density& density, FactorCache& cache, std::uint32_t who)
    : g_(g), density_(density), cache_(cache), stamp_((std::uint64_t{who} + 1) << 32U) {}

// ---- factors that each step changes ----

void StateChange::begin() {
  if (!steps_.empty()) return;
  ++stamp_;
  outcomes_.clear(), arrivals_.clear(), presences_.clear(), paired_.clear(), pairs_.clear();
}

bool StateChange::note(Index i, Factor factor) {
  auto& mark = cache_.marks_[i];
  if (mark.stamp != stamp_) mark.stamp = stamp_, mark.noted = 0;
  if ((mark.noted & factor) != 0) return false;
  mark.noted = static_cast<std::uint8_t>(mark.noted | factor);
  return true;
}
void StateChange::note_outcome(Index v) {
  if (note(v, FactorCache::kOutcome)) outcomes_.push_back(v);
}
void StateChange::note_arrival(Index w) {
  if (note(w, FactorCache::kArrival)) arrivals_.push_back(w);
}
void StateChange::note_presence(Index w) {
  if (note(w, FactorCache::kPresence)) presences_.push_back(w);
}

// The outcome of x changes; `dies`: also whether it dies.
void StateChange::note_outcomes_about(Index x, bool dies) {
  note_outcome(x);
  for (const Index guest : g_.guests(x))
    if (g_.is_active(guest)) note_outcome(guest);
  if (dies)
    for (const Index y : g_[x].edges) note_outcome(y);
}

// The rate at which others grow from w changes.
void StateChange::note_grown_from(Index w) {
  note_presence(w);
  for (const Index x : g_[w].edges)
    if (!g_.has_past(x)) note_arrival(x);
}

// `last`: v has no other link, so that it dies with this or without it.
void StateChange::note_link(Index v, Index w, bool last) {
  const Node &from = g_[v], &to = g_[w];
  note_outcomes_about(v, last);
  note_arrival(w);
  for (const Index x : to.prev)
    if (x != v) note_outcomes_about(x, false);
  for (const Index c : from.next) note_arrival(c);
  for (const Index c : to.next) note_arrival(c);
  note_grown_from(w);
  // The births of nodes that w precedes depend on whether w is new.
  if (to.prev.size() <= 1)
    for (const NeighbourCandidate& near : g_.neighbours(w))
      if (near.earlier && g_.is_active(near.node) && !g_.has_past(near.node)) note_arrival(near.node);
  if (note(w, FactorCache::kPairs)) paired_.push_back(w);
}

void StateChange::note_pair(Index a, Index b) {
  if (a == b || !g_.has_past(a) || !g_.has_past(b)) return;
  const Index first = std::min(a, b), second = std::max(a, b);
  const auto candidates = g_.neighbours(first);
  const auto near = std::ranges::find(candidates, second, &NeighbourCandidate::node);
  if (near == candidates.end()) return;
  const auto place = static_cast<std::size_t>(near - candidates.begin());
  if (std::ranges::none_of(pairs_, [&](const Pair& p) { return p.node == first && p.place == place; }))
    pairs_.push_back({first, place});
}

void StateChange::note_edge(Index a, Index b) {
  const bool coupled = density_.theta().displacement.coupling != 0;
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

void StateChange::note_isolated(Index i) {
  note_outcome(i);
  note_arrival(i);
  note_presence(i);
  for (const NeighbourCandidate& near : g_.neighbours(i))
    if (!near.earlier && g_.is_active(near.node) && !g_.has_past(near.node)) note_arrival(near.node);
}

// ---- values of the factors ----

// All noted pairs, each once.
template <class Visit>
void StateChange::visit_pairs(Visit visit) const {
  const auto paired = [&](Index x) {  // usually few, so a search is faster than a lookup
    return paired_.size() <= 4 ? std::ranges::find(paired_, x) != paired_.end()
                               : noted(x, FactorCache::kPairs);
  };
  for (const Index w : paired_) {
    const auto candidates = g_.neighbours(w);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (w < candidates[k].node || !paired(candidates[k].node)) visit(w, k);
  }
  for (const Pair& p : pairs_)
    if (!paired(p.node) && !paired(g_.neighbours(p.node)[p.place].node)) visit(p.node, p.place);
}

double StateChange::sum() const {
  double sum = 0;
  for (const Index v : outcomes_)
    if (g_.is_active(v)) sum += density_.log_outcome(g_, v);
  for (const Index w : arrivals_)
    if (g_.is_active(w)) sum += density_.log_birth_or_survival(g_, w);
  for (const Index w : presences_)
    if (g_.is_active(w)) sum += density_.log_presence(g_, w);
  visit_pairs([&](Index w, std::size_t k) { sum += density_.log_edge(g_, w, g_.neighbours(w)[k]); });
  return sum;
}

// Sum in the former state; none where a factor is not known.
std::optional<double> StateChange::known_sum() const {
  if (!cache_.enabled_) return std::nullopt;
  double sum = 0;
  bool known = true;
  const auto add = [&](const std::vector<Index>& list, Factor factor, double FactorCache::Mark::*value) {
    for (const Index i : list) {
      const auto& mark = cache_.marks_[i];
      known = known && (mark.known & factor) != 0;
      sum += mark.*value;
    }
  };
  add(outcomes_, FactorCache::kOutcome, &FactorCache::Mark::outcome);
  add(arrivals_, FactorCache::kArrival, &FactorCache::Mark::arrival);
  add(presences_, FactorCache::kPresence, &FactorCache::Mark::presence);
  if (!known) return std::nullopt;
  visit_pairs([&](Index w, std::size_t k) { sum += cache_.pairs_[cache_.first_[w] + k]; });
  return std::isnan(sum) ? std::nullopt : std::optional(sum);
}

// Sum of the noted factors in the former state, once that is restored. Computes and stores factors that are
// not known.
double StateChange::former_sum() {
  double sum = 0;
  const auto add = [&](const std::vector<Index>& list, Factor factor, double FactorCache::Mark::*value,
                       auto&& evaluate) {
    for (const Index i : list) {
      auto& mark = cache_.marks_[i];
      if (!cache_.enabled_ || (mark.known & factor) == 0) {
        mark.*value = g_.is_active(i) ? evaluate(i) : 0;
        mark.known = static_cast<std::uint8_t>(mark.known | factor);
      }
      sum += mark.*value;
    }
  };
  add(outcomes_, FactorCache::kOutcome, &FactorCache::Mark::outcome,
      [&](Index v) { return density_.log_outcome(g_, v); });
  add(arrivals_, FactorCache::kArrival, &FactorCache::Mark::arrival,
      [&](Index w) { return density_.log_birth_or_survival(g_, w); });
  add(presences_, FactorCache::kPresence, &FactorCache::Mark::presence,
      [&](Index w) { return density_.log_presence(g_, w); });
  visit_pairs([&](Index w, std::size_t k) {
    double* kept = cache_.enabled_ ? &cache_.pairs_[cache_.first_[w] + k] : nullptr;
    const double value =
        kept != nullptr && !std::isnan(*kept) ? *kept : density_.log_edge(g_, w, g_.neighbours(w)[k]);
    if (kept != nullptr) *kept = value;
    sum += value;
  });
  return sum;
}

// True if the noted factors may sum to `need` in the new state. They are evaluated only as long as upper
// bounds of the rest could still make up the difference.
bool StateChange::may_reach(double need) const {
  const double enough = need - 1e-9 * (1 + std::abs(need));  // rounding decides nothing
  double most = 0;
  for (const Index w : presences_)
    if (g_.is_active(w)) most += density_.log_presence(g_, w);
  for (const Index v : outcomes_)
    if (g_.is_active(v)) most += density_.max_log_outcome();
  for (const Index w : arrivals_)
    if (g_.is_active(w)) most += density_.max_log_birth_or_survival(g_, w);
  if (most < enough) return false;
  for (std::size_t k = 0; k < std::max(arrivals_.size(), outcomes_.size()); ++k) {
    if (k < arrivals_.size() && g_.is_active(arrivals_[k]))
      most += density_.log_birth_or_survival(g_, arrivals_[k]) -
              density_.max_log_birth_or_survival(g_, arrivals_[k]);
    if (k < outcomes_.size() && g_.is_active(outcomes_[k]))
      most += density_.log_outcome(g_, outcomes_[k]) - density_.max_log_outcome();
    if (most < enough) return false;
  }
  visit_pairs([&](Index w, std::size_t k) {
    if (most >= enough) most += density_.log_edge(g_, w, g_.neighbours(w)[k]);
  });
  return most >= enough;
}

double StateChange::gain(double least) {
  constexpr double kImpossible = -std::numeric_limits<double>::infinity();
  if (steps_.empty()) return 0;
  auto was = known_sum();
  if (!was) {
    for (std::size_t k = steps_.size(); k-- > 0;) revert(steps_[k]);
    was = former_sum();
    for (Step& step : steps_) apply(step);
  }
  if (least > kImpossible && !may_reach(least + *was - edges_)) return kImpossible;
  const double is = sum();
  return is == kImpossible ? kImpossible : is - *was + edges_;
}

double StateChange::edge_evidence(Index a, Index b) const {
  const auto near = std::ranges::find(g_.neighbours(a), b, &NeighbourCandidate::node);
  return near == g_.neighbours(a).end() ? 0 : double{near->evidence};
}

void StateChange::add(const Step& step) {
  steps_.push_back(step);
  apply(steps_.back());
}

void StateChange::link(Index v, Index w) {
  begin();
  note_link(v, w, g_[v].next.empty());
  add({StepKind::link, v, w, {}, 0});
}
void StateChange::unlink(Index v, Index w) {
  begin();
  note_link(v, w, g_[v].next.size() == 1);
  add({StepKind::unlink, v, w, {}, 0});
}
void StateChange::add_edge(Index a, Index b) {
  begin();
  note_edge(a, b);
  edges_ += edge_evidence(a, b);
  add({StepKind::add_edge, a, b, {}, 0});
}
void StateChange::remove_edge(Index a, Index b) {
  begin();
  note_edge(a, b);
  edges_ -= edge_evidence(a, b);
  add({StepKind::remove_edge, a, b, {}, 0});
}
void StateChange::activate(Index i) {
  begin();
  note_isolated(i);
  add({StepKind::activate, i, 0, {}, 0});
}
void StateChange::deactivate(Index i) {
  begin();
  note_isolated(i);
  add({StepKind::deactivate, i, 0, {}, 0});
}
void StateChange::set_displacement(Index i, double displacement) {
  begin();
  note_arrival(i);
  for (const Index c : g_[i].next) {
    note_arrival(c);
    for (const Index d : g_[c].next) note_arrival(d);
  }
  if (density_.theta().displacement.coupling != 0)
    for (const Index x : g_[i].edges)
      for (const Index c : g_[x].next) note_arrival(c);
  add({StepKind::displacement, i, 0, {}, displacement});
}

void StateChange::apply(Step& s) {
  switch (s.kind) {
    case StepKind::link:
      g_.link(s.a, s.b);
      break;
    case StepKind::unlink:
      s.at = g_.unlink(s.a, s.b);
      break;
    case StepKind::add_edge:
      g_.add_edge(s.a, s.b);
      break;
    case StepKind::remove_edge:
      s.at = g_.remove_edge(s.a, s.b);
      break;
    case StepKind::activate:
      s.at = g_.inactive_place(s.a);
      g_.activate(s.a);
      break;
    case StepKind::deactivate:
      s.at = g_.deactivate(s.a);
      break;
    case StepKind::displacement: {
      const double was = g_[s.a].displacement;
      g_.set_displacement(s.a, s.displacement);
      s.displacement = was;
      break;
    }
  }
}

void StateChange::revert(Step& s) {
  switch (s.kind) {
    case StepKind::link:
      g_.unlink(s.a, s.b);
      break;
    case StepKind::unlink:
      g_.undo_unlink(s.a, s.b, s.at);
      break;
    case StepKind::add_edge:
      g_.remove_edge(s.a, s.b);
      break;
    case StepKind::remove_edge:
      g_.undo_remove_edge(s.a, s.b, s.at);
      break;
    case StepKind::activate:
      g_.undo_activate(s.a, s.at);
      break;
    case StepKind::deactivate:
      g_.undo_deactivate(s.a, s.at);
      break;
    case StepKind::displacement:
      apply(s);  // changes places with what is there
      break;
  }
}

void StateChange::invalidate_noted() {
  const auto invalidate = [&](const std::vector<Index>& list, Factor factor) {
    for (const Index i : list) {
      auto& mark = cache_.marks_[i];
      mark.known = static_cast<std::uint8_t>(mark.known & ~factor);
    }
  };
  invalidate(outcomes_, FactorCache::kOutcome);
  invalidate(arrivals_, FactorCache::kArrival);
  invalidate(presences_, FactorCache::kPresence);
  visit_pairs([&](Index w, std::size_t k) {
    const Index x = g_.neighbours(w)[k].node;
    const auto back =
        std::ranges::find(g_.neighbours(x), w, &NeighbourCandidate::node) - g_.neighbours(x).begin();
    cache_.pairs_[cache_.first_[w] + k] = kUnknown;
    cache_.pairs_[cache_.first_[x] + static_cast<std::size_t>(back)] = kUnknown;
  });
}

void StateChange::commit() {
  if (!steps_.empty() && cache_.enabled_) invalidate_noted();
  steps_.clear();
  edges_ = 0;
}

void StateChange::rollback() {
  for (; !steps_.empty(); steps_.pop_back()) revert(steps_.back());
  edges_ = 0;
}

}  // namespace emberfold::mcmc
