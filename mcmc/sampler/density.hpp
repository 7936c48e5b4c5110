// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "mcmc/sampler/hidden_graph.hpp"
#include "mcmc/sampler/sampler_parameters.hpp"

namespace emberfold::mcmc {

/// What becomes of a node; the last frame's nodes have no outcome.
Outcome outcome(const HiddenGraph& g, Index v);
/// The predecessor that a node goes on from: the earliest in order; others merge into it.
inline Index parent(const HiddenGraph& g, Index w) {
  const auto& prev = g[w].prev;
  Index first = prev[0];
  for (std::size_t k = 1; k < prev.size(); ++k)
    if (g.precedes(prev[k], first)) first = prev[k];
  return first;
}
/// How many earlier nodes nearby go on as one, so that v could merge into them.
std::size_t merge_targets(const HiddenGraph& g, Index v);
/// What became of the neighbours that come before it: the index of Theta::outcome.
std::size_t outcome_context_of(const HiddenGraph& g, Index v);
/// Which of Theta::growth a node grows others by.
std::size_t parent_class(const HiddenGraph& g, Index w);
/// How two nodes that go on lay in the frame before.
PreviousAdjacency previous_adjacency(const HiddenGraph& g, Index a, Index b);
/// −1 where the normals of two nodes point to opposite sides, else 1.
inline double sense(const Node& a, const Node& b) {
  return graph::dot(a.tangent, b.tangent) < 0 ? -1 : 1;
}
/// Mean displacement of a node's neighbours, in the sense of its own normal; its own where it has none.
double neighbour_displacement(const HiddenGraph& g, Index v);

/// log p(G, L | θ) + the evidence, as a sum over nodes and pairs of nodes (formulas: docs/method/sampler.md).
/// Densities are with respect to counting of sets, edges and links, and lengths in px, rad and logarithms.
class Density {
 public:
  /// `evidence`: its power, 0…1; below 1 it is tempered.
  explicit Density(const SamplerParameters& theta, double evidence = 1);

  [[nodiscard]] const SamplerParameters& theta() const { return theta_; }
  /// Of what becomes of v.
  [[nodiscard]] double log_outcome(const HiddenGraph& g, Index v) const;
  /// Of where w came from, how it looks and displacements.
  [[nodiscard]] double log_birth_or_survival(const HiddenGraph& g, Index w) const;
  /// Of the displacement alone, given where w came from.
  [[nodiscard]] double log_displacement(const HiddenGraph& g, Index w) const;
  /// That nothing more than what does grows from w; and its evidence.
  [[nodiscard]] double log_presence(const HiddenGraph& g, Index w) const;
  /// What the image says of two nodes being joined.
  [[nodiscard]] double edge_evidence(const NeighbourCandidate& b) const { return evidence_ * double{b.evidence}; }
  /// What no outcome exceeds; and no arrival of a node that has a past, or none, as w.
  [[nodiscard]] double max_log_outcome() const { return max_outcome_; }
  [[nodiscard]] double max_log_birth_or_survival(const HiddenGraph& g, Index w) const {
    return g.has_past(w) ? max_survival_ : max_birth_ + std::max(0.0, g[w].log_birth);
  }
  /// Of whether two nodes that both go on are joined. 0 where one of them is new.
  [[nodiscard]] double log_edge(const HiddenGraph& g, Index a, const NeighbourCandidate& b) const;
  /// Keeps in the graph what hangs on θ and on places alone, and from now on takes it from there: for many
  /// looks at one graph. Candidates added later are not known.
  void prepare(HiddenGraph& g);
  /// All of it. O(nodes).
  [[nodiscard]] double total(const HiddenGraph& g) const;

  /// What of a new node's arrival each way explains: begun here, or grown from these; sums 1.
  struct Origins {
    double begun = 0;
    ShortList<kMostEdges> from;
    std::array<double, kMostEdges> shares{};
  };
  [[nodiscard]] Origins origins(const HiddenGraph& g, Index w) const;
  /// Mean and variance of w's displacement given where it came from.
  struct Normal {
    double mean = 0, variance = 1;
  };
  [[nodiscard]] Normal displacement_given_past(const HiddenGraph& g, Index w) const;
  /// The same of one that goes on from v, its normal pointing to the same side (1) or to the other (−1).
  [[nodiscard]] Normal displacement_given_past(const HiddenGraph& g, Index v, double same) const;
  [[nodiscard]] double stationary_sd() const;
  /// The chance that a change of this many SDs is an error of the sketch (kErrs).
  [[nodiscard]] static double outlier_probability(double z);

 private:
  struct BirthWays;
  void compute_bounds();
  [[nodiscard]] double log_parts(std::size_t parts) const;
  [[nodiscard]] BirthWays birth_ways(const HiddenGraph& g, Index w) const;
  [[nodiscard]] double log_birth(const HiddenGraph& g, Index w) const;
  [[nodiscard]] double log_appearance(const TransitionOffset& offset) const;
  [[nodiscard]] double log_new_stroke(const Node& w) const;
  [[nodiscard]] double log_grown(const Node& from, const Node& w) const;

  SamplerParameters theta_;
  double evidence_;
  bool prepared_ = false;
  double max_outcome_ = 0, max_survival_ = 0, max_birth_ = 0;
  /// [place][config][outcome], without and with nodes that it could merge into.
  std::array<std::array<std::array<double, kOutcomes>, kOutcomeContexts>, kPlaces> without_hosts_{}, with_hosts_{};
  std::array<std::array<std::array<double, 2>, kCloseness>, 3> joined_{};  ///< [were][closeness][joined]
  std::array<std::array<std::array<double, 2>, kCloseness>, 2> closed_{};
  std::array<double, kParentClasses> log_growth_{};
  double log_first_growth_ = 0, log_branch_ = 0, log_curve_ = 0, log_same_kind_ = 0, log_other_kind_ = 0;
  std::array<double, 2> log_birth_{};
  std::array<double, 3> log_kinds_{};
  double stationary_ = 1, lag_one_ = 0;  ///< variance and autocorrelation of the displacement
  /// Logarithms of the factors before the exponentials of normal densities.
  struct Scale {
    double sd = 1, peak = 0, half_precision = 0.5;
    Scale() = default;
    explicit Scale(double sd);
    [[nodiscard]] double log_normal(double x) const { return peak - half_precision * x * x; }
  };
  Scale begins_, lag_, noise_;           ///< of the displacement
  std::array<Scale, 2> across_, along_;  ///< of one that goes on, of a split's parts
  Scale turn_, wide_turn_, flicker_, new_contrast_, step_, side_, bend_, grown_contrast_;
};

}  // namespace emberfold::mcmc
