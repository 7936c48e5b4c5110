// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/stroke_statistics.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/comparison_results.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Sketches a clip that comes frame by frame and matches its strokes, as `emberfold analyze --bottom-up`
/// does.
class ClipStrokes {
 public:
  ClipStrokes(cv::Size size, double fps, const sketch::ExtractOptions& sketch,
              const graph::MatchOptions& match);

  /// Sketches the next frames' levels, CV_32F, 1 or 3 channels. Throws core::Cancelled.
  void add(std::span<const cv::Mat> levels, const core::Context& context);
  /// Matches all frames so far, bottom-up. Throws core::Cancelled.
  [[nodiscard]] graph::MotionGraph motion(const core::Context& context) const;
  /// Matches all frames so far and counts the events of their strokes. Throws core::Cancelled.
  [[nodiscard]] mcmc::StrokeSeries series(const core::Context& context) const;

 private:
  sketch::ExtractOptions extract_;
  graph::MatchOptions match_;
  graph::SketchSequence sketch_;
};

/// Matches the strokes of frames that are already sketched. Throws core::Cancelled.
graph::MotionGraph match_strokes(graph::SketchSequence sketch, const graph::MatchOptions& match,
                                 const core::Context& context);
/// Matches the strokes and counts their events. Throws core::Cancelled.
mcmc::StrokeSeries stroke_series(graph::SketchSequence sketch, const graph::MatchOptions& match,
                                 const core::Context& context);

/// Returns frames first … last − 1 of a series.
mcmc::StrokeSeries select_frames(const mcmc::StrokeSeries& series, int first, int last);

/// Returns "stroke_events", "stroke_lifetime" and "stroke_length", the distances of StrokeDistances.
std::span<const MeasureDescription> stroke_measures();

/// Measures the distances of a clip's strokes from those of a reference. Both have at least two frames.
StrokeDistances stroke_distances(const mcmc::StrokeStatistics& clip, const mcmc::StrokeStatistics& reference);

}  // namespace emberfold::pipeline
