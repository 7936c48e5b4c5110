// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Holds several interpretations of one clip: motion graphs matched in different ways. What they agree on is
/// likelier.
struct ClipReadings {
  std::vector<graph::MotionGraph> steadied;  ///< flicker removed; at least one, whose strokes events name
  std::vector<graph::MotionGraph> unsteadied = {};  ///< without flicker removal; may be empty
  std::vector<graph::MotionGraph> in_noise = {};    ///< of copies of the clip with added noise; may be empty
};

/// Matches the sketches of a clip forwards and backwards, with and without flicker removal.
/// Matched backwards, predicted velocities decide ambiguous matches differently. The interpretations of the
/// clip played backwards are these, reversed. `matched`: the forward match with these options. `of_curves`:
/// the interpretations' strokes are curves (graph::curves_as_strokes), like those of `matched`. Throws
/// core::Cancelled. Cost: three matches.
ClipReadings match_readings(const graph::SketchSequence& sketch, graph::MotionGraph matched,
                            const graph::MatchOptions& options, bool of_curves,
                            const core::Context& context = {});

/// Takes samples of a clip's graphs as its interpretations, with two matches of its sketches without flicker
/// removal. `samples`: at least one. Throws core::Cancelled. Cost: two matches.
ClipReadings sampled_readings(const graph::SketchSequence& sketch, std::vector<graph::MotionGraph> samples,
                              const graph::MatchOptions& options, const core::Context& context = {});

/// Adds the interpretations of a copy of the clip with added noise, matched like the clip, four times.
/// They contribute no events of their own, but show which of the clip's events recur. Throws core::Cancelled.
/// Cost: four matches.
void add_reading_in_noise(ClipReadings& readings, const graph::SketchSequence& copy,
                          const graph::MatchOptions& options, bool of_curves,
                          const core::Context& context = {});

}  // namespace emberfold::pipeline
