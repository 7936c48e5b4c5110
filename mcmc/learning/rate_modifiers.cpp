// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/rate_modifiers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "graph/events/event_family.hpp"
#include "mcmc/learning/event_history.hpp"
#include "mcmc/learning/operator_sites.hpp"
#include "mcmc/learning/stroke_places.hpp"

namespace emberfold::mcmc {

namespace {

using graph::EventType;

constexpr double near = 16;                                                    // px
constexpr std::array<double, kElapsedClasses - 1> begins = {4, 6, 9, 16, 32};  // frames
constexpr std::array<double, kGapClasses - 1> widths = {5, 7, 10, 14, 20};     // px

template <std::size_t kClasses>
struct ClassCounts {
  std::array<double, kClasses> events{}, expected{};

  [[nodiscard]] std::array<double, kClasses> ratios() const {
    std::array<double, kClasses> result{};
    for (std::size_t i = 0; i < kClasses; ++i) result[i] = (1 + events[i]) / (1 + expected[i]);
    return result;
  }
};

using detail::EventHistory;
using graph::detail::is_separation;
using graph::detail::is_union;

struct ModifierCounts {
  ClassCounts<kElapsedClasses> death, separation, unification;
  ClassCounts<kGapClasses> bridging;
  ClassCounts<kTurnClasses> turning;
};

std::size_t class_of(const graph::AttributeGraph& graph, const OperatorSites::Pair& pair) {
  return turn_class(turn_angle_towards(graph, pair));
}

void add_expected(const graph::AttributeGraph& graph, const graph::Components& parts,
                  const OperatorSites& found, const EventHistory& past, double frame,
                  const OperatorRates& rates, ModifierCounts& counts) {
  for (const auto& stroke : vertices_by_stroke(parts)) {
    const auto age = elapsed_class(past.age(graph.vertices()[stroke[0]].subgraph, frame));
    counts.death.expected[age] +=
        rates.death_by_size[size_class(stroke.size())] * rates.death.at(stroke_middle(graph, stroke));
  }
  const auto place = [&](std::uint32_t v) { return graph.patch(v).position; };
  const auto add = [&](ClassCounts<kElapsedClasses>& count, const std::vector<PastEvent>& what,
                       std::uint32_t v, double rate) {
    count.expected[elapsed_class(frames_since(what, place(v), frame))] += rate;
  };
  for (const auto v : found.split_sites)
    add(counts.separation, past.unions, v, rates.split * rates.separation.at(place(v)));
  for (const auto& arm : found.disconnect_sites)
    add(counts.separation, past.unions, arm.a, rates.disconnect * rates.separation.at(place(arm.a)));
  const auto add_pair = [&](const OperatorSites::Pair& pair, double rate) {
    add(counts.unification, past.separations, pair.a, rate);
    counts.bridging.expected[gap_class(graph::distance(place(pair.a), place(pair.b)))] += rate;
  };
  for (const auto& pair : found.merge_sites) add_pair(pair, rates.merge);
  for (const auto& pair : found.connect_sites) {
    add_pair(pair, rates.connect);
    counts.turning.expected[class_of(graph, pair)] += rates.connect;
  }
}

void add_event(const graph::Event& event, const graph::AttributeGraph& before, const OperatorSites& found,
               const EventHistory& past, ModifierCounts& counts) {
  const double frame = event.frame;
  if (event.type == EventType::death)
    ++counts.death.events[elapsed_class(past.age(event.before.at(0), frame))];
  if (is_separation(event.type))
    ++counts.separation.events[elapsed_class(frames_since(past.unions, event.position, frame))];
  if (!is_union(event.type)) return;
  ++counts.unification.events[elapsed_class(frames_since(past.separations, event.position, frame))];
  ++counts.bridging.events[gap_class(gap_between_strokes(before, event.before.at(0), event.before.at(1)))];
  const auto of = [&](std::uint32_t v) { return before.vertices()[v].subgraph; };
  for (const auto& pair : found.connect_sites)
    if (std::minmax(of(pair.a), of(pair.b)) == std::minmax(event.before.at(0), event.before.at(1)))
      ++counts.turning.events[class_of(before, pair)];
}

}  // namespace

std::size_t elapsed_class(double frames) {
  return static_cast<std::size_t>(std::ranges::upper_bound(begins, frames) - begins.begin());
}

std::size_t gap_class(double px) {
  return static_cast<std::size_t>(std::ranges::upper_bound(widths, px) - widths.begin());
}

std::size_t turn_class(double angle) {
  return std::min(kTurnClasses - 1, static_cast<std::size_t>(angle / (std::numbers::pi / 6)));
}

double frames_since(std::span<const PastEvent> all, graph::Point place, double frame) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& one : all) {
    const graph::Point apart = one.place - place;
    if (graph::dot(apart, apart) <= near * near) least = std::min(least, std::max(0.0, frame - one.frame));
  }
  return least;
}

RateModifiers estimate_rate_modifiers(const graph::MotionGraph& motion, std::span<const graph::Event> events,
                                      const OperatorRates& rates) {
  ModifierCounts counts;
  EventHistory past;
  auto event = events.begin();
  const auto& frames = motion.sketch.frames;
  for (std::size_t t = 1; t < frames.size(); ++t) {
    past.forget(static_cast<double>(t));
    const auto& before = frames[t - 1];
    const auto parts = graph::components(before);
    const OperatorSites found = find_sites(before, parts, rates.reach);
    add_expected(before, parts, found, past, static_cast<double>(t), rates, counts);
    const auto first = event;
    for (; event != events.end() && event->frame == static_cast<int>(t); ++event)
      add_event(*event, before, found, past, counts);
    std::for_each(first, event, [&](const graph::Event& one) { past.note(one); });
  }
  return {counts.death.ratios(),    counts.separation.ratios(), counts.unification.ratios(),
          counts.bridging.ratios(), counts.turning.ratios(),    1};
}

}  // namespace emberfold::mcmc
