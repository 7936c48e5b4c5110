// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

/// Outcome of a patch in the next frame.
/// death: nothing continues it. survival: one patch continues it. split: several do. merge: it joins the
/// patch that an earlier neighbour continues as.
enum class Outcome : std::uint8_t { death, survival, split, merge };
constexpr std::size_t kOutcomes = 4;

/// Classes on which the outcome's probabilities depend.
/// They are the degree (0, 1, 2, 3 or more), whether it lies near the frame's border, and the outcomes of the
/// neighbours earlier in order: there are none; all continue; some died.
constexpr std::size_t kDegrees = 4, kNeighbourOutcomes = 3;
constexpr std::size_t kOutcomeContexts = kDegrees * 2 * kNeighbourOutcomes;
constexpr std::size_t outcome_context(std::size_t degree, bool border, std::size_t neighbour_outcome) {
  return ((degree < kDegrees ? degree : kDegrees - 1) * 2 + (border ? 1 : 0)) * kNeighbourOutcomes +
         neighbour_outcome;
}

/// Number of classes of what a patch grows from.
/// A continued patch at an end (degree 0, 1), inside a curve, at a junction; or a new patch.
constexpr std::size_t kParentClasses = 4;

/// Relation of two patches' predecessors.
/// apart: neither joined nor joined to a common patch. near: joined to a common patch; the sketch places
/// patches anew along a curve in every frame, so these may be neighbours now. joined: joined, or the same
/// patch.
enum class PreviousAdjacency : std::uint8_t { apart, near, joined };

/// Share of outliers, errors of the sketch, in changes of direction and contrast; how many times wider they
/// spread.
constexpr double kOutlierShare = 0.05, kOutlierScale = 4;

/// Holds θ of the sampler's density (docs/method/sampler.md).
/// Probabilities are in (0, 1), rates above 0. Of pairs [2] the first is for frame 0, the second for later
/// frames.
struct SamplerParameters {
  std::array<std::array<double, kOutcomes>, kOutcomeContexts> outcome{};  ///< sums 1
  double split_more = 0.05;                     ///< probability of each further successor, beyond two
  std::array<double, 2> birth{};                ///< strokes begun, per px²
  std::array<double, kParentClasses> growth{};  ///< expected number of patches that grow from one; from a new
                                                ///< one to both sides, of which one comes later in order
  double first_growth = 1.6;                    ///< expected number in frame 0, where all are new
  /// Probability that two patches which continue are joined, by their relation before and their position now.
  std::array<std::array<double, kCloseness>, 3> join{};
  std::array<std::array<double, kCloseness>, 2> close{};  ///< probability that a new patch is joined to one
                                                          ///< it is not grown from
  double across = 0.5,
         along = 1.5;       ///< px: SD of a patch about the place that displacement and drift predict
  double turn = 0.15;       ///< rad
  double flicker = 0.2;     ///< SD of the change of the logarithm of the contrast
  double split_spread = 2;  ///< how many times wider the places of a split's parts spread
  double new_contrast = 3, new_contrast_sd = 0.7;  ///< of the logarithm, where a stroke begins
  std::array<double, 3> kinds = {1. / 3, 1. / 3, 1. / 3};
  double step = 5, step_sd = 1;         ///< px from a patch to the one that grows from it along the curve
  double side_sd = 0.7, bend_sd = 0.2;  ///< px, rad: SD of its distance from the line, and of its turn
  double grown_contrast_sd = 0.3;
  double branch = 0.1;       ///< share that grows into any direction, up to branch_reach
  double branch_reach = 12;  ///< px
  double other_kind = 0.02;  ///< probability that it is of another kind
  Autoregression displacement{1.5, -0.7, 0, 0.4, 0, 0};  ///< law of the displacement from rest, px
};

/// Checks θ. Throws core::InputError, naming the field, for a number out of its range.
void validate(const SamplerParameters& theta);

/// Returns usual numbers for a clip of so many patches a frame over so many px².
SamplerParameters default_parameters(double patches, double area);

}  // namespace emberfold::mcmc
