// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "graph/events.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/motion_model.hpp"

namespace emberfold::mcmc {

/// Sufficient statistics of the operator rates: what happened, and how often it could have.
struct OperatorCounts {
  struct Tally {
    double happened = 0, could = 0;
    Tally& operator+=(const Tally& o) { return happened += o.happened, could += o.could, *this; }
  };
  Tally split, merge, connect, disconnect;        ///< could: sites × frames (mcmc/sites.hpp)
  std::array<Tally, kSizes> death;                ///< could: strokes × frames
  std::vector<CellMap> births, deaths, partings;  ///< of every gap between frames: how many in each cell
  CellMap partable;   ///< splits and disconnects expected in each cell by the sites alone
  CellMap strokes;    ///< deaths expected in each cell by the strokes' sizes alone
  double reach = 24;  ///< px: nine in ten unions bridged no more
  double split_gap = 10, disconnect_gap = 10;  ///< px, medians
  double gaps = 0;                             ///< between frames

  /// Events by kind, for reports: birth, death, split, merge, connect, disconnect.
  std::array<double, 6> events{};
};

/// `events` are motion's stroke events. O(n log n).
OperatorCounts count_operators(const graph::MotionGraph& motion, std::span<const graph::Event> events);

struct RateEstimate {
  OperatorRates rates;
  std::vector<std::string> notes;
};
/// Posterior means under Gamma priors drawn towards the mean over the sizes. Maps: counts and exposures
/// smoothed by one kernel, whose width makes the events of each frame likeliest given the others'; drawn
/// towards the frame's mean by as much as one event. The births' sizes are left to whoever knows what is
/// born.
RateEstimate estimate_rates(const OperatorCounts& counts);

/// A stroke's middle: the patch nearest the mean of its places.
graph::Point middle(const graph::AttributeGraph& graph, std::span<const std::uint32_t> stroke);

/// The vertices of each component.
std::vector<std::vector<std::uint32_t>> strokes(const graph::Components& parts);

}  // namespace emberfold::mcmc
