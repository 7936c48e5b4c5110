// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/clip_readings.hpp"

#include <utility>

#include "graph/curves/curve_identity.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "graph/matching/time_reversal.hpp"

namespace emberfold::pipeline {

ClipReadings match_readings(const graph::SketchSequence& sketch, graph::MotionGraph matched,
                            const graph::MatchOptions& options, bool of_curves,
                            const core::Context& context) {
  const auto with_strokes = [&](graph::MotionGraph motion) {
    if (!of_curves) return motion;
    return graph::curves_as_strokes(graph::identify_curves(std::move(motion), context).motion);
  };
  const auto quiet = context.with_progress({});
  const graph::SketchSequence reversed = graph::reverse_time(sketch);
  const auto match_backwards = [&](const graph::MatchOptions& how) {
    return with_strokes(graph::reverse_time(graph::match(reversed, how, quiet)));
  };
  graph::MatchOptions as_sketched = options;
  as_sketched.flicker = 0;
  ClipReadings readings;
  readings.steadied.push_back(std::move(matched));
  readings.steadied.push_back(match_backwards(options));
  readings.unsteadied.push_back(with_strokes(graph::match(sketch, as_sketched, quiet)));
  readings.unsteadied.push_back(match_backwards(as_sketched));
  return readings;
}

}  // namespace emberfold::pipeline
