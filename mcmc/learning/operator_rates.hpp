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

/// Sufficient statistics of the operator rates: what happened, and how often it could have.
struct OperatorCounts {
  struct Tally {
    double happened = 0, could = 0;
    double variance = 0;  ///< of `happened` between the samples of the clip's graph that it is the mean of
    Tally& operator+=(const Tally& o) {
      return happened += o.happened, could += o.could, variance += o.variance, *this;
    }
  };
  Tally split, merge, connect, disconnect;  ///< could: sites × frames (mcmc/learning/operator_sites.hpp)
  std::array<Tally, kSizes> death;          ///< could: strokes × frames
  std::vector<CellMap> births, deaths, partings;  ///< of every gap between frames: how many in each cell
  CellMap partable;   ///< splits and disconnects expected in each cell by the sites alone
  CellMap strokes;    ///< deaths expected in each cell by the strokes' sizes alone
  double reach = 24;  ///< px: nine in ten unions bridged no more
  double split_gap = 10, disconnect_gap = 10;  ///< px, medians
  double gaps = 0;                             ///< between frames

  /// Events by kind, for reports: birth, death, split, merge, connect, disconnect.
  std::array<double, 6> events{};
  std::array<double, 6> events_variance{};  ///< between samples
};

/// `events` are motion's stroke events. O(n log n).
OperatorCounts count_operators(const graph::MotionGraph& motion, std::span<const graph::Event> events);

/// What several samples of one clip's graph count on average, and how far their counts differ. InputError for
/// none, or samples of unlike maps or numbers of frames.
OperatorCounts mean(std::span<const OperatorCounts> samples);

/// A rate and what it may be: with 90 % probability (or another that is told) it lies between `low` and
/// `high`.
struct RateInterval {
  double mean = 0, low = 0, high = 0;
};

/// Of a Gamma law of so many events in so much time (shape `events` + `prior_events`, rate `time` +
/// `prior_time`, > 0) whose variance is increased by that of `events`, `variance` (law of total variance; the
/// Gamma law of that mean and variance stands for the mixture).
RateInterval rate_interval(double events, double time, double variance, double prior_events,
                           double prior_time, double probability = 0.9);

struct RateEstimate {
  OperatorRates rates;
  /// Expected number of each kind of event (graph::EventType) a frame: Jeffreys' prior; 0 and what it may be
  /// at most where none was seen.
  std::array<RateInterval, 6> a_frame{};
  std::array<RateInterval, kSizes> death_by_size{};  ///< per stroke and frame, about rates.death_by_size
  std::vector<std::string> notes;
};
/// Posterior means under Gamma priors drawn towards the mean over the sizes. Maps: counts and exposures
/// smoothed by one kernel, whose width makes the events of each frame likeliest given the others'; drawn
/// towards the frame's mean by as much as one event. The births' sizes are left to whoever knows what is
/// born.
RateEstimate estimate_rates(const OperatorCounts& counts);

/// A stroke's middle: the patch nearest the mean of its places.
graph::Point middle(const graph::AttributeGraph& graph, std::span<const std::uint32_t> stroke);

/// px between the nearest patches of two strokes of a frame; infinite where one of them is not there.
double gap_between(const graph::AttributeGraph& graph, graph::SubgraphId a, graph::SubgraphId b);

/// The vertices of each component.
std::vector<std::vector<std::uint32_t>> strokes(const graph::Components& parts);

}  // namespace emberfold::mcmc
