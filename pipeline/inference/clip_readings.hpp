// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Holds motion graphs of one clip that were matched in several ways. What they agree on is likelier.
struct ClipReadings {
  std::vector<graph::MotionGraph> steadied;    ///< flicker removed; at least one, whose strokes events name
  std::vector<graph::MotionGraph> unsteadied;  ///< of the sketches as they are; may be empty
};

/// Matches the sketches of a clip forwards and backwards, with and without what is taken for flicker.
/// Matched backwards, velocities that are carried on decide otherwise where the match is in doubt. The
/// readings of the clip played backwards are these, reversed. `matched`: the forward match with these
/// options. `of_curves`: the readings' strokes are curves (graph::curves_as_strokes), as those of `matched`.
/// Throws core::Cancelled. Cost: three matches.
ClipReadings match_readings(const graph::SketchSequence& sketch, graph::MotionGraph matched,
                            const graph::MatchOptions& options, bool of_curves,
                            const core::Context& context = {});

}  // namespace emberfold::pipeline
