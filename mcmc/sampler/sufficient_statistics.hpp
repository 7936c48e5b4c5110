// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// Holds the sufficient statistics of θ in a state: events, occasions and sums of squares.
/// A new patch that may have come in several ways counts in each by its probability (Density::origins).
struct SufficientStatistics {
  std::array<std::array<double, kOutcomes>, kOutcomeContexts> outcome{};  ///< number of each
  std::array<double, kOutcomeContexts> exposed{};    ///< Σ of the death map over the occasions
  std::array<double, kOutcomeContexts> no_target{};  ///< occasions without a patch to merge into
  double splits = 0, more_parts = 0;                 ///< parts beyond two
  std::array<double, 2> begun{};                     ///< strokes, in frame 0 and later
  double later_frames = 0;
  std::array<double, kParentClasses> grown{}, parents{};
  double first_grown = 0, first_parents = 0;
  struct Pair {
    double joined = 0, exposure = 0;
  };
  std::array<std::array<Pair, kCloseness>, 3> join{};
  std::array<std::array<Pair, kCloseness>, 2> close{};
  double survival = 0, across2 = 0, along2 = 0, turn2 = 0, flicker2 = 0;
  double contrast = 0, contrast2 = 0;  ///< of strokes begun
  std::array<double, 3> kinds{};
  double grown_along_curve = 0, grown_elsewhere = 0, step = 0, step2 = 0, side2 = 0, bend2 = 0,
         grown_contrast2 = 0, other_kind = 0;
  /// Sums over displacements with a past of two frames, z = (d(t), d(t−1), n̄(t) − d(t)), y = d(t+1): Σ z zᵀ
  /// (lower triangle), Σ z y, Σ y² and their number.
  std::array<double, 6> displacement_zz{};
  std::array<double, 3> displacement_zy{};
  double displacement_yy = 0, displacement_count = 0;

  /// Adds γ (other − this) to every number.
  void blend(const SufficientStatistics& other, double gamma);
};

/// Computes the statistics. `density` has the θ that weighs the ways in which new patches came. O(nodes).
SufficientStatistics sufficient_statistics(const HiddenGraph& g, const Density& density);

/// Returns the θ of greatest posterior density, under weak conjugate priors about `prior`.
/// Each prior is worth `weight` occasions. Numbers without statistics are taken from `prior`. An unstable law
/// of the displacement is drawn back to a spectral radius of 0.995.
SamplerParameters most_likely_parameters(const SufficientStatistics& statistics,
                                         const SamplerParameters& prior, double area, double weight = 2);

}  // namespace emberfold::mcmc
