// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "mcmc/model/motion_model.hpp"
#include "mcmc/sampler/hidden_graph.hpp"

namespace emberfold::mcmc {

/// What becomes of a patch in the next frame: nothing; one patch that goes on from it; several; or it goes
/// into the one that a neighbour earlier in order goes on as.
enum class Outcome : std::uint8_t { death, survival, split, merge };
constexpr std::size_t kOutcomes = 4;

/// On what its chances depend: its degree (0, 1, 2, 3 or more), whether it lies near the frame's border, and
/// what became of its neighbours that come earlier in order: there are none; all stay; some died.
constexpr std::size_t kDegrees = 4, kNeighbourOutcomes = 3;
constexpr std::size_t kOutcomeContexts = kDegrees * 2 * kNeighbourOutcomes;
constexpr std::size_t outcome_context(std::size_t degree, bool border, std::size_t neighbour_outcome) {
  return ((degree < kDegrees ? degree : kDegrees - 1) * 2 + (border ? 1 : 0)) * kNeighbourOutcomes + neighbour_outcome;
}

/// From what a patch grows: a patch that goes on from an end (degree 0, 1), from inside a curve, from a
/// junction; or one that is new.
constexpr std::size_t kParentClasses = 4;

/// How two patches lay in the frame before: neither joined nor joined to the same; joined to the same
/// (patches are set down anew along a curve in every frame, and what was next but one may be next now);
/// joined, or one.
enum class PreviousAdjacency : std::uint8_t { apart, near, joined };

/// What a patch looks like as it goes on is normal, but for this share, which spreads this many times wider:
/// the sketch errs now and then.
constexpr double kOutlierShare = 0.05, kOutlierScale = 4;

/// θ of the sampler's density (docs/method/sampler.md). Chances are in (0, 1), rates above 0. [2]: in frame 0, in
/// later ones.
struct SamplerParameters {
  std::array<std::array<double, kOutcomes>, kOutcomeContexts> outcome{};  ///< sums 1
  double split_more = 0.05;               ///< chance of yet another successor, beyond two
  std::array<double, 2> birth{};          ///< strokes begun, per px²
  std::array<double, kParentClasses> growth{};  ///< patches that grow from one, expected number; from a new one to
                                          ///< both sides, of which one comes later in order
  double first_growth = 1.6;              ///< the same in frame 0, where all are new
  /// Chance that two patches which go on are joined, by how they lay before and how they lie now.
  std::array<std::array<double, kCloseness>, 3> join{};
  std::array<std::array<double, kCloseness>, 2> close{};  ///< that a new patch is joined to one it is not
                                                          ///< grown from
  double across = 0.5, along = 1.5;  ///< px: SD of a patch about where its displacement and drift carry it
  double turn = 0.15;                ///< rad
  double flicker = 0.2;              ///< SD of the change of the logarithm of the contrast
  double split_spread = 2;           ///< how many times wider the places of a split's parts spread
  double new_contrast = 3, new_contrast_sd = 0.7;  ///< of the logarithm, where a stroke begins
  std::array<double, 3> kinds = {1. / 3, 1. / 3, 1. / 3};
  double step = 5, step_sd = 1;         ///< px from a patch to what grows from it along the curve
  double side_sd = 0.7, bend_sd = 0.2;  ///< px, rad: how far that lies beside the line, and turns
  double grown_contrast_sd = 0.3;
  double branch = 0.1;                           ///< share of what grows into any direction, up to the gate
  double branch_reach = 12;                      ///< px
  double other_kind = 0.02;                      ///< chance that what grows is of another kind
  Autoregression displacement{1.5, -0.7, 0, 0.4, 0, 0};  ///< of the displacement from rest, px
};

/// Throws InputError, naming the field, where a number is out of its range.
void validate(const SamplerParameters& theta);

/// Where to begin: usual numbers, for a clip of this many patches a frame over so many px².
SamplerParameters usual_parameters(double patches, double area);

}  // namespace emberfold::mcmc
