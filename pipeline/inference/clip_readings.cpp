// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/clip_readings.hpp"

#include <utility>

#include "graph/curves/curve_identity.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "graph/matching/time_reversal.hpp"

namespace emberfold::pipeline {

namespace {

graph::MotionGraph with_strokes(graph::MotionGraph motion, bool of_curves, const core::Context& context) {
  if (!of_curves) return motion;
  return graph::curves_as_strokes(graph::identify_curves(std::move(motion), context).motion);
}

}  // namespace

ClipReadings match_readings(const graph::SketchSequence& sketch, graph::MotionGraph matched,
                            const graph::MatchOptions& options, bool of_curves,
                            const core::Context& context) {
  const auto quiet = context.with_progress({});
  const graph::SketchSequence reversed = graph::reverse_time(sketch);
  const auto match_backwards = [&](const graph::MatchOptions& how) {
    return with_strokes(graph::reverse_time(graph::match(reversed, how, quiet)), of_curves, context);
  };
  graph::MatchOptions as_sketched = options;
  as_sketched.flicker = 0;
  ClipReadings readings;
  readings.steadied.push_back(std::move(matched));
  readings.steadied.push_back(match_backwards(options));
  readings.unsteadied.push_back(with_strokes(graph::match(sketch, as_sketched, quiet), of_curves, context));
  readings.unsteadied.push_back(match_backwards(as_sketched));
  return readings;
}

void add_reading_in_noise(ClipReadings& readings, const graph::SketchSequence& copy,
                          const graph::MatchOptions& options, bool of_curves, const core::Context& context) {
  auto matched = graph::match(copy, options, context.with_progress({}));
  auto read =
      match_readings(copy, with_strokes(std::move(matched), of_curves, context), options, of_curves, context);
  for (auto* some : {&read.steadied, &read.unsteadied})
    for (graph::MotionGraph& motion : *some) readings.in_noise.push_back(std::move(motion));
}

}  // namespace emberfold::pipeline
