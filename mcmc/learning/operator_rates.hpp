// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/clip_statistics.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Counts the events and sites of a matched clip; `events` are its stroke events. O(n log n).
OperatorCounts count_operators(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Computes the credible interval of a rate under a Gamma law.
/// Its shape is `events` + `prior_events`, its rate `time` + `prior_time` (> 0). Its variance is increased by
/// `variance`, the variance of `events` (law of total variance); a Gamma law of the same mean and variance
/// stands for the mixture. Throws core::InputError where shape or rate is not above 0.
RateInterval rate_interval(double events, double time, double variance, double prior_events,
                           double prior_time, double probability = 0.9);

/// Holds estimated rates and their intervals.
struct RateEstimate {
  OperatorRates rates;
  /// Expected number of each kind of event (graph::EventType) in a frame under Jeffreys' prior; `low` is 0
  /// for a kind that was never observed.
  std::array<RateInterval, 6> events_per_frame{};
  std::array<RateInterval, kSizeClasses>
      death_by_size{};  ///< per stroke and frame, about rates.death_by_size
  std::vector<std::string> notes;
};
/// Estimates the rates as posterior means under Gamma priors that shrink towards the mean over sizes.
/// Maps are ratios of counts and exposures smoothed by one kernel and shrunk towards the frame's mean with
/// the weight of one event; the kernel's width maximises the likelihood of each frame's events given the
/// others'. `birth_by_size` is left to the caller, who has the exemplars.
RateEstimate estimate_rates(const OperatorCounts& counts);

}  // namespace emberfold::mcmc
