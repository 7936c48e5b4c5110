// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// Marks the factors that a change has noted, so that each counts once, and caches their values.
/// One cache serves all changes of a state, also at the same time if they lie six frames apart and their
/// `who` differ.
class FactorCache {
 public:
  /// Prepares for changes of states of up to so many nodes.
  void resize(std::size_t nodes) { marks_.resize(nodes); }
  /// Prepares for changes of `g`, and keeps factors from one change to the next.
  /// Call invalidate() after changing the state or θ by other means than committed changes. Candidates must
  /// stay the same.
  void enable(const HiddenGraph& g);
  /// Forgets all factors.
  void invalidate();
  /// Forgets the factors that depend on displacements.
  void invalidate_arrivals();

 private:
  friend class StateChange;
  enum Factor : std::uint8_t { kOutcome = 1, kArrival = 2, kPresence = 4, kPairs = 8 };
  struct alignas(64) Mark {
    std::uint64_t stamp = 0;  ///< of the change that noted it
    std::uint8_t noted = 0, known = 0;
    double outcome = 0, arrival = 0, presence = 0;  ///< where known; 0 of a node that is off
  };
  std::vector<Mark> marks_;
  bool enabled_ = false;
  /// Factors of each node's pairs with its neighbours, from first_[node] on; NaN where not known.
  std::vector<std::size_t> first_;
  std::vector<double> pairs_;
};

/// Changes a state step by step and computes the change of its density.
/// Each step notes the factors that it touches; gain() evaluates each of them once before and once after.
/// Until commit(), rollback() takes all steps back and restores the state bit by bit. Steps do not check
/// whether they are allowed.
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

  /// Returns the change of the log density since the start or the last commit().
  /// −∞ where the state is impossible, and where the change is certain to be below `least` (cheaper than the
  /// full sum).
  [[nodiscard]] double gain(double least = -std::numeric_limits<double>::infinity());
  [[nodiscard]] const HiddenGraph& state() const { return g_; }
  [[nodiscard]] const Density& density() const { return density_; }
  [[nodiscard]] bool empty() const { return steps_.empty(); }
  void commit();
  void rollback();

 private:
  enum class StepKind : std::uint8_t {
    link,
    unlink,
    add_edge,
    remove_edge,
    activate,
    deactivate,
    displacement
  };
  struct Step {
    StepKind kind = StepKind::link;
    Index a = 0, b = 0;
    HiddenGraph::Places at;
    double displacement = 0;
  };
  /// Two nodes of a frame: `place` is an index into g.neighbours(node).
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
  double edges_ = 0;  ///< change of the edges' evidence
  std::vector<Step> steps_;
  std::vector<Index> outcomes_, arrivals_, presences_, paired_;
  std::vector<Pair> pairs_;
};

}  // namespace emberfold::mcmc
