// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/clip_strokes.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "core/parallel.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::array<MeasureDescription, 3> kStrokeMeasures{{
    {"stroke_events", "Event rates", "ln ratio",
     "births, deaths, splits, merges, connects, disconnects a frame; 0.7 is twice or half as often"},
    {"stroke_lifetime", "Stroke lifetime", "ln ratio", "frames that a stroke lives between two events"},
    {"stroke_length", "Stroke length", "ln ratio", "px of curve in a stroke"},
}};

constexpr double kHalfEvent = 0.5;  // added to counts, so that an empty class has a logarithm

bool lies_inside(double value, const mcmc::RateInterval& interval) {
  return interval.low <= value && value <= interval.high;
}

std::optional<double> log_ratio(double a, double b) {
  return a > 0 && b > 0 ? std::optional(std::abs(std::log(a / b))) : std::nullopt;
}

}  // namespace

ClipStrokes::ClipStrokes(cv::Size size, double fps, const sketch::ExtractOptions& sketch,
                         const graph::MatchOptions& match)
    : extract_(sketch), match_(match) {
  sketch_.width = size.width, sketch_.height = size.height, sketch_.fps = fps;
}

void ClipStrokes::add(std::span<const cv::Mat> levels, const core::Context& context) {
  std::vector<graph::AttributeGraph> graphs(levels.size());
  core::parallel_for(levels.size(), context,
                     [&](std::size_t i) { graphs[i] = sketch::extract(levels[i], extract_); });
  for (const auto& graph : graphs) sketch_.append(graph);
}

graph::MotionGraph ClipStrokes::motion(const core::Context& context) const {
  return match_strokes(sketch_, match_, context);
}

mcmc::StrokeSeries ClipStrokes::series(const core::Context& context) const {
  return stroke_series(sketch_, match_, context);
}

graph::MotionGraph match_strokes(graph::SketchSequence sketch, const graph::MatchOptions& match,
                                 const core::Context& context) {
  return graph::match(std::move(sketch), match, context);
}

mcmc::StrokeSeries stroke_series(graph::SketchSequence sketch, const graph::MatchOptions& match,
                                 const core::Context& context) {
  const auto motion = match_strokes(std::move(sketch), match, context);
  return mcmc::stroke_series(motion, graph::stroke_events(motion));
}

mcmc::StrokeSeries select_frames(const mcmc::StrokeSeries& series, int first, int last) {
  const auto slice = [](const std::vector<double>& values, int from, int to) {
    return std::vector<double>(values.begin() + from, values.begin() + to);
  };
  mcmc::StrokeSeries out;
  for (std::size_t type = 0; type < out.events.size(); ++type)
    out.events[type] = slice(series.events[type], first, last - 1);
  out.strokes = slice(series.strokes, first, last);
  out.ended = slice(series.ended, first, last);
  out.length = slice(series.length, first, last);
  return out;
}

std::span<const MeasureDescription> stroke_measures() {
  return kStrokeMeasures;
}

StrokeDistances stroke_distances(const mcmc::StrokeStatistics& clip,
                                 const mcmc::StrokeStatistics& reference) {
  StrokeDistances out;
  double squares = 0;
  for (std::size_t type = 0; type < out.rate_inside.size(); ++type) {
    const double ratio = std::log((clip.happened[type] + kHalfEvent) / (clip.frames - 1)) -
                         std::log((reference.happened[type] + kHalfEvent) / (reference.frames - 1));
    squares += ratio * ratio;
    out.rate_inside[type] = lies_inside(clip.events_a_frame[type].mean, reference.events_a_frame[type]);
  }
  out.event_rates = std::sqrt(squares / 6);
  out.lifetime = log_ratio(clip.lifetime.mean, reference.lifetime.mean);
  out.length = log_ratio(clip.length.mean, reference.length.mean);
  out.lifetime_inside = lies_inside(clip.lifetime.mean, reference.lifetime);
  out.length_inside = lies_inside(clip.length.mean, reference.length);
  return out;
}

}  // namespace emberfold::pipeline
