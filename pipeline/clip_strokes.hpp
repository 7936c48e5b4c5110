// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/learning/stroke_statistics.hpp"
#include "pipeline/clip_measures.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Finds the strokes of a clip that comes frame by frame, as `emberfold analyze --bottom-up` does.
class ClipStrokes {
 public:
  ClipStrokes(cv::Size size, double fps, const sketch::ExtractOptions& sketch,
              const graph::MatchOptions& match);

  /// The next frames' levels, CV_32F, 1 or 3 channels. Throws core::Cancelled.
  void add(std::span<const cv::Mat> levels, const core::Context& context);
  /// All frames so far, matched bottom up. Throws core::Cancelled.
  [[nodiscard]] graph::MotionGraph motion(const core::Context& context) const;
  /// What happened in them. Throws core::Cancelled.
  [[nodiscard]] mcmc::StrokeSeries series(const core::Context& context) const;

 private:
  sketch::ExtractOptions extract_;
  graph::MatchOptions match_;
  graph::SketchSequence sketch_;
};

/// The same of frames that are sketched already. Throws core::Cancelled.
graph::MotionGraph match_strokes(graph::SketchSequence sketch, const graph::MatchOptions& match,
                                 const core::Context& context);
mcmc::StrokeSeries stroke_series(graph::SketchSequence sketch, const graph::MatchOptions& match,
                                 const core::Context& context);

/// Frames first … last − 1 of a series.
mcmc::StrokeSeries select_frames(const mcmc::StrokeSeries& series, int first, int last);

/// {"frames", "strokes_a_frame", "events": {class: {"count", "a_frame", "low", "high"}}, "lifetime",
/// "length": {"mean", "low", "high"}}; what is not known is null.
nlohmann::ordered_json strokes_json(const mcmc::StrokeStatistics& strokes);

/// The stroke measures, as pixel_measures().
std::span<const Measure> stroke_measures();

/// {key: distance} for every stroke measure: "stroke_events" is the RMS over the six classes of ln of the
/// ratio of rates, half an event added to each count; "stroke_lifetime" and "stroke_length" |ln ratio|, null
/// where either has none. {"inside"}: by event class and for both means, whether `a`'s lies in the 95 % of
/// the reference `b`'s.
nlohmann::ordered_json stroke_distances(const mcmc::StrokeStatistics& a, const mcmc::StrokeStatistics& b);

}  // namespace emberfold::pipeline
