// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/context.hpp"
#include "graph/events/events.hpp"
#include "pipeline/figures/figure_regions.hpp"

namespace emberfold::pipeline {

/// A change of the regions of one polarity between frames `frame` − 1 and `frame`.
struct FigureChange {
  std::size_t frame = 0;
  graph::EventType type = graph::EventType::birth;  ///< birth, death, split or merge
  cv::Point2d at;                                   ///< px of the view
  double width = 0;                                 ///< px, of what appears, vanishes, parts or joins
  std::size_t whole = 0, part = 0;                  ///< regions: of a split or merge both, else the same
};

/// Finds the changes of a polarity's figures.
std::vector<FigureChange> find_figure_changes(const FigureRegions& all, std::size_t polarity,
                                              const FigureGround& ground, const core::Context& context);

/// A change of a clip's figures.
struct FigureEvent {
  FigureChange change;
  std::size_t polarity = 0;  ///< index of kFigurePolarities
  double probability = 0;
};

/// Returns the changes of a clip, each with its probability: the share of the thresholds at which it is seen
/// at its place within 6 frames. Throws core::Cancelled. O(changes · pixels).
std::vector<FigureEvent> weigh_figure_changes(const FigureRegions& all, const FigureGround& ground,
                                              const core::Context& context);

}  // namespace emberfold::pipeline
