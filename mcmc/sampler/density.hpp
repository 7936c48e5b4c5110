// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "mcmc/sampler/hidden_graph.hpp"
#include "mcmc/sampler/sampler_parameters.hpp"

namespace emberfold::mcmc {

/// Returns the outcome of a node. The last frame's nodes have none.
Outcome outcome(const HiddenGraph& g, Index v);
/// Returns the predecessor that a node continues: the earliest in order; the others merge into the node.
inline Index parent(const HiddenGraph& g, Index w) {
  const auto& prev = g[w].prev;
  Index first = prev[0];
  for (std::size_t k = 1; k < prev.size(); ++k)
    if (g.precedes(prev[k], first)) first = prev[k];
  return first;
}
/// Counts the earlier nodes nearby that continue as one node, so that v could merge into them.
std::size_t merge_targets(const HiddenGraph& g, Index v);
/// Returns the index into SamplerParameters::outcome, by degree, border and the outcomes of earlier
/// neighbours.
std::size_t outcome_context_of(const HiddenGraph& g, Index v);
/// Returns the index into SamplerParameters::growth for what grows from a node.
std::size_t parent_class(const HiddenGraph& g, Index w);
/// Returns how the predecessors of two nodes lay in the frame before.
PreviousAdjacency previous_adjacency(const HiddenGraph& g, Index a, Index b);
/// Returns −1 where the normals of two nodes point to opposite sides, else 1.
inline double sense(const Node& a, const Node& b) {
  return graph::dot(a.tangent, b.tangent) < 0 ? -1 : 1;
}
/// Returns the mean displacement of a node's neighbours in the sense of its own normal; without any, its own.
double neighbour_displacement(const HiddenGraph& g, Index v);

/// Computes log p(G, L | θ) + the evidence as a sum over nodes and pairs of nodes.
/// Formulas: docs/method/sampler.md. Densities are with respect to counting measure for sets, edges and
/// links, and to lengths in px, rad and logarithms.
class Density {
 public:
  explicit Density(const SamplerParameters& theta);

  [[nodiscard]] const SamplerParameters& theta() const { return theta_; }
  /// Returns the log probability of v's outcome.
  [[nodiscard]] double log_outcome(const HiddenGraph& g, Index v) const;
  /// Returns the log density of w's origin, displacement, place and look.
  [[nodiscard]] double log_birth_or_survival(const HiddenGraph& g, Index w) const;
  /// Returns the log density of w's displacement and place across the curve, given its origin.
  [[nodiscard]] double log_displacement(const HiddenGraph& g, Index w) const;
  /// Returns w's evidence plus the log probability that nothing else grows from it.
  [[nodiscard]] double log_presence(const HiddenGraph& g, Index w) const;
  /// Returns an upper bound of log_outcome().
  [[nodiscard]] double max_log_outcome() const { return max_outcome_; }
  /// Returns an upper bound of log_birth_or_survival() of nodes that have a past, or none, as w.
  [[nodiscard]] double max_log_birth_or_survival(const HiddenGraph& g, Index w) const {
    return g.has_past(w) ? max_survival_ : max_birth_ + std::max(0.0, g[w].log_birth);
  }
  /// Returns the log probability that two nodes that both continue are joined or not. 0 where either is new.
  [[nodiscard]] double log_edge(const HiddenGraph& g, Index a, const NeighbourCandidate& b) const;
  /// Stores in the graph the terms that depend on θ and on places alone, and uses them from then on.
  /// It pays where one graph is evaluated many times. Candidates added later are not known.
  void prepare(HiddenGraph& g);
  /// Returns the whole log density. O(nodes).
  [[nodiscard]] double total(const HiddenGraph& g) const;

  /// Holds the probability of each way in which a new node may have come; they sum to 1.
  struct Origins {
    double begun = 0;
    ShortList<kMostEdges> from;
    std::array<double, kMostEdges> shares{};
  };
  [[nodiscard]] Origins origins(const HiddenGraph& g, Index w) const;
  /// Holds the mean and variance of a displacement given the node's origin.
  struct Normal {
    double mean = 0, variance = 1;
  };
  [[nodiscard]] Normal displacement_given_past(const HiddenGraph& g, Index w) const;
  /// Returns the law of a node that continues v; `same`: 1 where the normals point to one side, else −1.
  [[nodiscard]] Normal displacement_given_past(const HiddenGraph& g, Index v, double same) const;
  [[nodiscard]] double stationary_sd() const;
  /// Returns the probability that a change of `z` SDs is an error of the sketch (kOutlierShare).
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
  bool prepared_ = false;
  double max_outcome_ = 0, max_survival_ = 0, max_birth_ = 0;
  /// [place][config][outcome], without and with nodes that it could merge into.
  std::array<std::array<std::array<double, kOutcomes>, kOutcomeContexts>, kPlaces> without_hosts_{},
      with_hosts_{};
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
