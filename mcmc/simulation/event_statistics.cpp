// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/event_statistics.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "mcmc/simulation/simulation_step.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double most_patches = 8e5;  // in all frames that are simulated

// Strokes gained by births, deaths, splits, merges, connects, disconnects.
constexpr std::array<double, 6> gained = {1, -1, 1, -1, -1, 1};

void count_strokes(const graph::AttributeGraph& graph, double share, EventStatistics& statistics) {
  statistics.patches += share * static_cast<double>(graph.size());
  for (const auto& stroke : vertices_by_stroke(graph::components(graph)))
    statistics.strokes[size_class(stroke.size())] += share;
}

}  // namespace

EventStatistics event_statistics(const graph::MotionGraph& motion, std::span<const graph::Event> events) {
  const auto& frames = motion.sketch.frames;
  if (frames.size() < 2)
    throw core::InputError("a census takes a clip of two frames or more; here are " +
                           std::to_string(frames.size()));
  EventStatistics result;
  for (const auto& graph : frames) count_strokes(graph, 1 / static_cast<double>(frames.size()), result);
  for (const auto& event : events)
    result.events[static_cast<std::size_t>(event.type)] += 1 / (static_cast<double>(frames.size()) - 1);
  return result;
}

EventStatistics event_statistics(const OperatorCounts& counts, double patches) {
  EventStatistics result;
  for (std::size_t s = 0; s < kSizeClasses; ++s) result.strokes[s] = counts.death[s].exposure / counts.gaps;
  for (std::size_t i = 0; i < counts.events.size(); ++i) result.events[i] = counts.events[i] / counts.gaps;
  result.patches = patches;
  return result;
}

void reconcile_event_rates(EventStatistics& statistics) {
  double more = 0, all = 0;
  for (std::size_t i = 0; i < gained.size(); ++i)
    more += gained[i] * statistics.events[i], all += statistics.events[i];
  if (all <= 0) return;
  for (std::size_t i = 0; i < gained.size(); ++i) statistics.events[i] *= 1 - gained[i] * more / all;
}

namespace detail {

EventStatistics simulate_statistics(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                                    std::uint32_t first, int frames, CellMap* where) {
  EventStatistics result;
  LinkedFrames linked;
  linked.motion.sketch.width = model.width, linked.motion.sketch.height = model.height;
  linked.append(stroke_graph(strokes));
  for (int t = 0; t < frames; ++t) {
    (void)advance_frame(strokes, model, seed, first + static_cast<std::uint32_t>(t));
    linked.append(stroke_graph(strokes));
    count_strokes(linked.last, 1.0 / frames, result);
    if (!where) continue;
    for (const auto& vertex : linked.last.vertices())
      where->values[where->index(vertex.patch.position)] += 1.0 / frames;
  }
  for (const auto& event : graph::stroke_events(graph::identify(std::move(linked.motion))))
    result.events[static_cast<std::size_t>(event.type)] += 1.0 / frames;
  return result;
}

int frames_per_round(const MotionModel& model, int rounds) {
  const double patches = std::max(1.0, static_cast<double>(model.first.size()));
  return std::clamp(static_cast<int>(most_patches / rounds / patches), 4, 60);
}

}  // namespace detail

}  // namespace emberfold::mcmc
