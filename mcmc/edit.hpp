// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "mcmc/density.hpp"

namespace emberfold::mcmc {

/// Marks of what an edit has noted, so that it counts it once. One serves all edits of a state, also at the
/// same time if they lie six frames apart and their `who` differ.
struct Scratch {
  struct Value {
    double value = 0;
    bool known = false;
  };
  std::vector<std::uint64_t> outcome, arrival, presence, pairs;
  /// What factors were when last evaluated. Taken for true if it remembers: then whoever changes the state or
  /// θ by other means than edits that are kept tells it to forget.
  bool remembers = false;
  std::vector<Value> outcome_values, arrival_values, presence_values;
  void fit(std::size_t nodes);
  void forget();
};

/// A change of a state, step by step, and what it does to its density. Each step notes the factors that it
/// touches; gain() evaluates all of them before and after, each once. Until keep(), undo() takes all steps
/// back and leaves the state as it was, bit by bit. Steps ask nothing: whether they may be taken is the
/// caller's to know.
class Edit {
 public:
  Edit(HiddenGraph& g, const Density& density, Scratch& scratch, std::uint32_t who = 0);

  void link(Index v, Index w);
  void unlink(Index v, Index w);
  void join(Index a, Index b);
  void cut(Index a, Index b);
  void put(Index i);
  void take(Index i);
  void set_sway(Index i, double sway);

  /// Change of the log density since it began or was last kept; −∞ where the state that it led to cannot be.
  [[nodiscard]] double gain();
  [[nodiscard]] const HiddenGraph& state() const { return g_; }
  [[nodiscard]] const Density& density() const { return density_; }
  [[nodiscard]] bool empty() const { return steps_.empty(); }
  void keep();
  void undo();

 private:
  enum class What : std::uint8_t { link, unlink, join, cut, put, take, sway };
  struct Step {
    What what = What::link;
    Index a = 0, b = 0;
    HiddenGraph::Places at;
    double sway = 0;
  };
  void begin();
  void note_outcome(Index v);
  void note_arrival(Index w);
  void note_presence(Index w);
  void note_new_beside(Index w);
  void note_pairs(Index w);
  void note_link(Index v, Index w);
  void note_edge(Index a, Index b);
  void note_lone(Index i);
  [[nodiscard]] double sum();
  double kept_sum();
  [[nodiscard]] double pairs_sum() const;
  [[nodiscard]] double edge_evidence(Index a, Index b) const;
  void add(const Step& step);
  void take_back(Step& step);
  void take_again(Step& step);

  HiddenGraph& g_;
  const Density& density_;
  Scratch& scratch_;
  std::uint64_t stamp_;
  double edges_ = 0;  ///< gain of evidence for edges
  std::vector<Step> steps_;
  std::vector<Index> outcomes_, arrivals_, presences_, paired_;
  std::vector<std::pair<Index, Beside>> pairs_;
};

}  // namespace emberfold::mcmc
