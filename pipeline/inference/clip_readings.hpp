// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Holds motion graphs of one clip that were matched in several ways. What they agree on is likelier.
struct ClipReadings {
  std::vector<graph::MotionGraph> steadied;  ///< flicker removed; at least one, whose strokes events name
  std::vector<graph::MotionGraph> unsteadied = {};  ///< of the sketches as they are; may be empty
  std::vector<graph::MotionGraph> in_noise = {};    ///< of copies of the clip in noise; may be empty
};

/// Matches the sketches of a clip forwards and backwards, with and without what is taken for flicker.
/// Matched backwards, velocities that are carried on decide otherwise where the match is in doubt. The
/// readings of the clip played backwards are these, reversed. `matched`: the forward match with these
/// options. `of_curves`: the readings' strokes are curves (graph::curves_as_strokes), as those of `matched`.
/// Throws core::Cancelled. Cost: three matches.
ClipReadings match_readings(const graph::SketchSequence& sketch, graph::MotionGraph matched,
                            const graph::MatchOptions& options, bool of_curves,
                            const core::Context& context = {});

/// Takes samples of a clip's graphs as its readings, with two matches of its sketches as they are.
/// `samples`: at least one. Throws core::Cancelled. Cost: two matches.
ClipReadings sampled_readings(const graph::SketchSequence& sketch, std::vector<graph::MotionGraph> samples,
                              const graph::MatchOptions& options, const core::Context& context = {});

/// Adds what a copy of the clip in noise is read as: matched as the clip is, four times.
/// Such readings bring no events of their own; they tell which of the clip's would be there again. Throws
/// core::Cancelled. Cost: four matches.
void add_reading_in_noise(ClipReadings& readings, const graph::SketchSequence& copy,
                          const graph::MatchOptions& options, bool of_curves,
                          const core::Context& context = {});

}  // namespace emberfold::pipeline
