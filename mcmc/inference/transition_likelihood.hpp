// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Holds log P of what happens between two frames, in terms that add up. Nats; lengths in px, contrasts as
/// logarithms, births per px².
struct TransitionLikelihood {
  double displacement = 0;                ///< of the places on curves that go on, across their curves
  double contrast = 0;                    ///< of their contrast
  std::array<double, 6> events{};         ///< by graph::EventType; of none, too
  std::size_t places = 0;                 ///< places that displacement and contrast are of
  std::array<std::size_t, 6> happened{};  ///< number of events, by graph::EventType

  [[nodiscard]] double motion() const { return displacement + contrast; }
  [[nodiscard]] double total() const;
};

/// Computes log P[G(t), links | G(t−1), …, G(0), Θ] of every gap between frames (Wang & Zhu 2004, eqs. 3, 4).
/// - Displacement and contrast: densities of each place on a curve that goes on, given its past: a Kalman
///   filter over deviation and unknown rest. Places of one curve count as independent given their past,
///   although the model draws their noise smooth along the curve: the sum is a composite likelihood.
/// - Deaths: each stroke dies or not, by the model's rate for its size, place and age.
/// - Splits, disconnects, merges and connects: independent Poisson numbers at the sites where they can
///   happen, and 0.001 a frame elsewhere.
/// - Births: a Poisson process in the plane with the model's map, and the share of the stroke's size.
/// Place and look of new patches, and the growth of ends, have no density under the model and are left out.
/// `motion`: with its strokes identified. Element t − 1 is the gap before frame t. Throws core::InputError
/// for an invalid model, and for a clip of another size or of fewer than two frames; core::Cancelled.
/// O(samples + sites).
std::vector<TransitionLikelihood> transition_likelihoods(const MotionModel& model,
                                                         const graph::MotionGraph& motion,
                                                         const core::Context& context = {});

/// Holds means over the gaps of a clip, nats.
struct MeanTransition {
  double displacement = 0, contrast = 0, total = 0;
  double motion_per_place = 0;  ///< nats: displacement and contrast of a place, in the mean over all places
  std::array<double, 6> events{};
};
/// Returns the mean of each term over the gaps. Throws core::InputError for no gap.
MeanTransition mean_transition(const std::vector<TransitionLikelihood>& gaps);

}  // namespace emberfold::mcmc
