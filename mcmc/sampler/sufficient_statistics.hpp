// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// Sufficient statistics of θ in a state: what happened, how often it could have, and sums of squares.
/// Where a new patch may have come in several ways each counts by its chance (Density::origins).
struct SufficientStatistics {
  std::array<std::array<double, kOutcomes>, kOutcomeContexts> outcome{};  ///< how often each was
  std::array<double, kOutcomeContexts> exposed{};                         ///< Σ of the death map over the occasions
  std::array<double, kOutcomeContexts> no_target{};  ///< occasions without anything to merge into
  double splits = 0, more_parts = 0;         ///< parts beyond two
  std::array<double, 2> begun{};             ///< strokes, in frame 0 and later
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
  /// Of displacements with two of past, z = (d(t), d(t−1), n̄(t) − d(t)): Σ z zᵀ (lower triangle), Σ z y, Σ y², how
  /// many.
  std::array<double, 6> displacement_zz{};
  std::array<double, 3> displacement_zy{};
  double displacement_yy = 0, displacement_count = 0;

  /// this += γ (other − this), every number of it.
  void blend(const SufficientStatistics& other, double gamma);
};

/// O(nodes). `density`: of the θ that tells how new patches have come.
SufficientStatistics sufficient_statistics(const HiddenGraph& g, const Density& density);

/// The θ of greatest posterior density given the tallies, under weak conjugate priors about `prior`, each
/// worth `weight` occasions. What the tallies do not tell of is taken over from `prior`. A displacement that would
/// not be stable is drawn back to a spectral radius of 0.995.
SamplerParameters most_likely_parameters(const SufficientStatistics& statistics, const SamplerParameters& prior, double area, double weight = 2);

}  // namespace emberfold::mcmc
