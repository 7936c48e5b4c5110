// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Holds sufficient statistics of the operator rates: events and the sites at which they could happen.
struct OperatorCounts {
  /// Holds a number of events and the number of occasions for them.
  struct Count {
    double events = 0, exposure = 0;
    double variance = 0;  ///< of `events` between the samples of the clip's graph that it is the mean of
    Count& operator+=(const Count& o) {
      return events += o.events, exposure += o.exposure, variance += o.variance, *this;
    }
  };
  Count split, merge, connect, disconnect;  ///< could: sites × frames (mcmc/learning/operator_sites.hpp)
  std::array<Count, kSizeClasses> death;    ///< could: strokes × frames
  std::vector<CellMap> births, deaths, separations;  ///< of every gap between frames: how many in each cell
  CellMap expected_separations;  ///< splits and disconnects expected in each cell by the sites alone
  CellMap expected_deaths;       ///< deaths expected in each cell by the strokes' sizes alone
  double reach = 24;             ///< px: nine in ten unions bridged no more
  double split_gap = 10, disconnect_gap = 10;  ///< px, medians
  double gaps = 0;                             ///< between frames

  /// Events by kind, for reports: birth, death, split, merge, connect, disconnect.
  std::array<double, 6> events{};
  std::array<double, 6> events_variance{};  ///< between samples
};

/// Counts the events and sites of a matched clip; `events` are its stroke events. O(n log n).
OperatorCounts count_operators(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// Averages the counts of several samples of one clip's graph and adds the variance between samples.
/// Throws core::InputError for no sample, and for samples of different maps or numbers of frames.
OperatorCounts mean_counts(std::span<const OperatorCounts> samples);

/// Holds a rate with its credible interval from `low` to `high`, of 90 % unless another probability is named.
struct RateInterval {
  double mean = 0, low = 0, high = 0;
};

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
