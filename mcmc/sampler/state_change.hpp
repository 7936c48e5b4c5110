// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// What an edit has noted, so that it counts it once, and what factors are. One serves all edits of a state,
/// also at the same time if they lie six frames apart and their `who` differ.
class FactorCache {
 public:
  /// For edits of states of up to so many nodes.
  void resize(std::size_t nodes) { marks_.resize(nodes); }
  /// The same, and what factors are is kept from one edit to the next. Who changes the state or θ by other
  /// means than edits that are kept tells it to forget; candidates stay what they are.
  void enable(const HiddenGraph& g);
  void invalidate();
  /// Sways have changed, nothing else.
  void invalidate_arrivals();

 private:
  friend class StateChange;
  enum Factor : std::uint8_t { kOutcome = 1, kArrival = 2, kPresence = 4, kPairs = 8 };
  struct alignas(64) Mark {
    std::uint64_t stamp = 0;  ///< of the edit that noted it
    std::uint8_t noted = 0, known = 0;
    double outcome = 0, arrival = 0, presence = 0;  ///< where known; 0 of a node that is off
  };
  std::vector<Mark> marks_;
  bool enabled_ = false;
  /// Of each node's pairs with those beside it, from first_[node] on; NaN where not known.
  std::vector<std::size_t> first_;
  std::vector<double> pairs_;
};

/// A change of a state, step by step, and what it does to its density. Each step notes the factors that it
/// touches; gain() evaluates all of them before and after, each once. Until keep(), rollback() takes all steps
/// back and leaves the state as it was, bit by bit. Steps ask nothing: whether they may be taken is the
/// caller's to know.
class StateChange {
 public:
  StateChange(HiddenGraph& g, const Density& density, FactorCache& cache, std::uint32_t who = 0);

  void link(Index v, Index w);
  void unlink(Index v, Index w);
  void add_edge(Index a, Index b);
  void remove_edge(Index a, Index b);
  void activate(Index i);
  void deactivate(Index i);
  void set_displacement(Index i, double displacement);

  /// Change of the log density since it began or was last kept; −∞ where the state that it led to cannot be,
  /// and also where it is certain to be less than `least` (which costs less than to evaluate it all).
  [[nodiscard]] double gain(double least = -std::numeric_limits<double>::infinity());
  [[nodiscard]] const HiddenGraph& state() const { return g_; }
  [[nodiscard]] const Density& density() const { return density_; }
  [[nodiscard]] bool empty() const { return steps_.empty(); }
  void commit();
  void rollback();

 private:
  enum class StepKind : std::uint8_t { link, unlink, add_edge, remove_edge, activate, deactivate, displacement };
  struct Step {
    StepKind kind = StepKind::link;
    Index a = 0, b = 0;
    HiddenGraph::Places at;
    double displacement = 0;
  };
  /// Two nodes of a frame: `beside` is a place in g.beside(node).
  struct Pair {
    Index node = 0;
    std::size_t place = 0;
  };
  using Factor = FactorCache::Factor;
  void begin();
  bool note(Index i, Factor factor);
  void note_outcome(Index v);
  void note_arrival(Index w);
  void note_presence(Index w);
  void note_outcomes_about(Index x, bool dies);
  void note_grown_from(Index w);
  void note_link(Index v, Index w, bool last);
  void note_edge(Index a, Index b);
  void note_pair(Index a, Index b);
  void note_isolated(Index i);
  [[nodiscard]] bool noted(Index i, Factor factor) const {
    const auto& mark = cache_.marks_[i];
    return mark.stamp == stamp_ && (mark.noted & factor) != 0;
  }
  template <class Visit>
  void visit_pairs(Visit visit) const;
  [[nodiscard]] double sum() const;
  [[nodiscard]] std::optional<double> known_sum() const;
  double former_sum();
  [[nodiscard]] bool may_reach(double need) const;
  void invalidate_noted();
  [[nodiscard]] double edge_evidence(Index a, Index b) const;
  void add(const Step& step);
  void revert(Step& step);
  void apply(Step& step);

  HiddenGraph& g_;
  const Density& density_;
  FactorCache& cache_;
  std::uint64_t stamp_;
  double edges_ = 0;  ///< gain of evidence for edges
  std::vector<Step> steps_;
  std::vector<Index> outcomes_, arrivals_, presences_, paired_;
  std::vector<Pair> pairs_;
};

}  // namespace emberfold::mcmc
