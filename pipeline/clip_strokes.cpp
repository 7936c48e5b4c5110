// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_strokes.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "core/parallel.hpp"

namespace emberfold::pipeline {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::array<Measure, 3> kMeasures{{
    {"stroke_events", "Event rates", "ln ratio",
     "births, deaths, splits, merges, connects, disconnects a frame; 0.7 is twice or half as often"},
    {"stroke_lifetime", "Stroke lifetime", "ln ratio", "frames that a stroke lives between two events"},
    {"stroke_length", "Stroke length", "ln ratio", "px of curve in a stroke"},
}};

constexpr std::array<graph::EventType, 6> kTypes{graph::EventType::birth,   graph::EventType::death,
                                                 graph::EventType::split,   graph::EventType::merge,
                                                 graph::EventType::connect, graph::EventType::disconnect};

Json number(double value) {
  return std::isfinite(value) ? Json(std::round(value * 1e5) / 1e5) : Json(nullptr);
}

Json interval_json(const mcmc::RateInterval& interval) {
  if (!(interval.mean > 0)) return nullptr;
  return {{"mean", number(interval.mean)}, {"low", number(interval.low)}, {"high", number(interval.high)}};
}

bool within(double value, const mcmc::RateInterval& interval) {
  return interval.low <= value && value <= interval.high;
}

Json log_ratio(double a, double b) {
  return a > 0 && b > 0 ? Json(rounded(std::abs(std::log(a / b)))) : Json(nullptr);
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
  const auto cut = [](const std::vector<double>& values, int from, int to) {
    return std::vector<double>(values.begin() + from, values.begin() + to);
  };
  mcmc::StrokeSeries out;
  for (std::size_t type = 0; type < out.events.size(); ++type)
    out.events[type] = cut(series.events[type], first, last - 1);
  out.strokes = cut(series.strokes, first, last);
  out.ended = cut(series.ended, first, last);
  out.length = cut(series.length, first, last);
  return out;
}

Json strokes_json(const mcmc::StrokeStatistics& strokes) {
  Json events = Json::object();
  for (const auto type : kTypes) {
    const auto i = static_cast<std::size_t>(type);
    const auto& rate = strokes.events_a_frame[i];
    events[std::string(graph::name(type))] = {{"count", strokes.happened[i]},
                                              {"a_frame", number(rate.mean)},
                                              {"low", number(rate.low)},
                                              {"high", number(rate.high)}};
  }
  return {{"frames", strokes.frames},
          {"strokes_a_frame", rounded(strokes.strokes_a_frame)},
          {"events", std::move(events)},
          {"lifetime", interval_json(strokes.lifetime)},
          {"length", interval_json(strokes.length)}};
}

std::span<const Measure> stroke_measures() {
  return kMeasures;
}

Json stroke_distances(const mcmc::StrokeStatistics& a, const mcmc::StrokeStatistics& b) {
  double squares = 0;
  Json inside = Json::object();
  for (const auto type : kTypes) {
    const auto i = static_cast<std::size_t>(type);
    const double ratio =
        std::log((a.happened[i] + 0.5) / (a.frames - 1)) - std::log((b.happened[i] + 0.5) / (b.frames - 1));
    squares += ratio * ratio;
    inside[std::string(graph::name(type))] = within(a.events_a_frame[i].mean, b.events_a_frame[i]);
  }
  inside["lifetime"] = within(a.lifetime.mean, b.lifetime);
  inside["length"] = within(a.length.mean, b.length);
  return {{"stroke_events", rounded(std::sqrt(squares / 6))},
          {"stroke_lifetime", log_ratio(a.lifetime.mean, b.lifetime.mean)},
          {"stroke_length", log_ratio(a.length.mean, b.length.mean)},
          {"inside", std::move(inside)}};
}

}  // namespace emberfold::pipeline
