// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "pipeline/figures/figure_regions.hpp"

namespace emberfold::pipeline {

/// A change of the regions of one reading between frames `frame` − 1 and `frame`.
struct FigureChange {
  std::size_t frame = 0;
  graph::EventType type = graph::EventType::birth;  ///< birth, death, split or merge
  cv::Point2d at;                                   ///< px of the view
  double width = 0;                                 ///< px, of what appears, vanishes, parts or joins
  std::size_t whole = 0, part = 0;                  ///< regions: of a split or merge both, else the same
};

/// Finds the changes of a reading's figures. Those that undo one another within 3 frames and 12 px are none.
std::vector<FigureChange> find_figure_changes(const FigureRegions& all, std::size_t reading,
                                              const FigureGround& ground, const core::Context& context);

/// A change of a clip's figures, as all readings see it.
struct FigureEvent {
  FigureChange change;      ///< of the threshold nearest to 0 that sees it
  std::size_t reading = 0;  ///< that threshold's
  double probability = 0;
};

/// Returns the changes of a clip, each with its probability: the share of the thresholds that see it.
/// Throws core::Cancelled.
std::vector<FigureEvent> weigh_figure_changes(const FigureRegions& all, const FigureGround& ground,
                                              const core::Context& context);

}  // namespace emberfold::pipeline
