// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "mcmc/model/motion_model.hpp"

// Numbers of the strokes and events of a clip.
namespace emberfold::mcmc {

/// Holds a rate with its credible interval from `low` to `high`, of 90 % unless another probability is named.
struct RateInterval {
  double mean = 0, low = 0, high = 0;
};

/// Holds sufficient statistics of the operator rates: events and the sites at which they could happen.
struct OperatorCounts {
  /// Holds a number of events and the number of occasions for them.
  struct Count {
    double events = 0, exposure = 0;
    Count& operator+=(const Count& o) { return events += o.events, exposure += o.exposure, *this; }
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
};

/// Holds mean numbers of a clip, per frame.
struct EventStatistics {
  std::array<double, kSizeClasses> strokes{};  ///< of each size
  std::array<double, 6> events{};              ///< of each kind: graph::EventType
  double patches = 0;
};

/// Holds statistics of the strokes of a clip, each with a 95 % interval.
struct StrokeStatistics {
  int frames = 0;
  std::array<double, 6> happened{};  ///< by graph::EventType
  std::array<RateInterval, 6> events_a_frame;
  double strokes_a_frame = 0;
  RateInterval lifetime;  ///< frames: stroke-frames over ends, so that strokes cut by the clip's ends count
  RateInterval length;    ///< px, of a stroke
};

}  // namespace emberfold::mcmc
