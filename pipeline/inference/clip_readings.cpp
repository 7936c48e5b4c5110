// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/clip_readings.hpp"

#include <utility>
#include <vector>

#include "graph/curves/curve_identity.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "graph/matching/time_reversal.hpp"

namespace emberfold::pipeline {

namespace {

graph::MotionGraph with_strokes(graph::MotionGraph motion, bool of_curves, const core::Context& context) {
  if (!of_curves) return motion;
  return graph::curves_as_strokes(graph::identify_curves(std::move(motion), context).motion);
}

graph::MotionGraph match_backwards(const graph::SketchSequence& sketch, const graph::MatchOptions& options,
                                   const core::Context& context) {
  return graph::reverse_time(graph::match(graph::reverse_time(sketch), options, context.with_progress({})));
}

/// Matches the sketches without flicker removal, forwards and backwards.
std::vector<graph::MotionGraph> match_unsteadied(const graph::SketchSequence& sketch,
                                                 graph::MatchOptions options, bool of_curves,
                                                 const core::Context& context) {
  options.flicker = 0;
  std::vector<graph::MotionGraph> both;
  both.push_back(with_strokes(graph::match(sketch, options, context.with_progress({})), of_curves, context));
  both.push_back(with_strokes(match_backwards(sketch, options, context), of_curves, context));
  return both;
}

}  // namespace

ClipReadings match_readings(const graph::SketchSequence& sketch, graph::MotionGraph matched,
                            const graph::MatchOptions& options, bool of_curves,
                            const core::Context& context) {
  ClipReadings readings;
  readings.steadied.push_back(std::move(matched));
  readings.steadied.push_back(with_strokes(match_backwards(sketch, options, context), of_curves, context));
  readings.unsteadied = match_unsteadied(sketch, options, of_curves, context);
  return readings;
}

ClipReadings sampled_readings(const graph::SketchSequence& sketch, std::vector<graph::MotionGraph> samples,
                              const graph::MatchOptions& options, const core::Context& context) {
  return {std::move(samples), match_unsteadied(sketch, options, false, context), {}};
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
