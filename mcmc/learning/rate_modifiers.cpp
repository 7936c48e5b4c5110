// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/rate_modifiers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/learning/operator_sites.hpp"

namespace emberfold::mcmc {

namespace {

using graph::EventType;

constexpr double near = 16;                                           // px
constexpr std::array<double, kSince - 1> begins = {4, 6, 9, 16, 32};  // frames
constexpr std::array<double, kGaps - 1> widths = {5, 7, 10, 14, 20};  // px

template <std::size_t kClasses>
struct Tally {
  std::array<double, kClasses> happened{}, expected{};

  [[nodiscard]] std::array<double, kClasses> relative() const {
    std::array<double, kClasses> result{};
    for (std::size_t i = 0; i < kClasses; ++i) result[i] = (1 + happened[i]) / (1 + expected[i]);
    return result;
  }
};

bool is_union(EventType type) {
  return type == EventType::merge || type == EventType::connect;
}
bool is_parting(EventType type) {
  return type == EventType::split || type == EventType::disconnect;
}

// What has happened in a clip until a frame.
struct Past {
  std::vector<Happening> unions, partings;
  std::map<graph::SubgraphId, double> born;

  [[nodiscard]] std::size_t age(graph::SubgraphId stroke, double frame) const {
    const auto found = born.find(stroke);
    return since_class(found == born.end() ? std::numeric_limits<double>::infinity() : frame - found->second);
  }
  void forget(double frame) {
    const auto long_ago = [frame](const Happening& one) { return frame - one.frame >= begins.back(); };
    std::erase_if(unions, long_ago);
    std::erase_if(partings, long_ago);
  }
  void note(const graph::Event& event) {
    const double frame = event.frame;
    if (event.type == EventType::birth) born[event.after.at(0)] = frame;
    if (is_union(event.type)) unions.push_back({event.position, frame});
    if (is_parting(event.type)) partings.push_back({event.position, frame});
    // What comes of strokes is as old as the oldest of them.
    double began = std::numeric_limits<double>::infinity();
    for (const auto stroke : event.before) {
      const auto found = born.find(stroke);
      if (found == born.end()) return;
      began = std::min(began, found->second);
    }
    for (const auto stroke : event.after) born.try_emplace(stroke, began);
  }
};

struct Tallies {
  Tally<kSince> death, parting, uniting;
  Tally<kGaps> bridging;
  Tally<kTurns> turning;
};

std::size_t class_of(const graph::AttributeGraph& graph, const Sites::Pair& pair) {
  return turn_class(turn_towards(graph, pair));
}

void expect(const graph::AttributeGraph& graph, const graph::Components& parts, const Sites& found,
            const Past& past, double frame, const OperatorRates& rates, Tallies& tallies) {
  for (const auto& stroke : strokes(parts)) {
    const auto age = past.age(graph.vertices()[stroke[0]].subgraph, frame);
    tallies.death.expected[age] +=
        rates.death_by_size[size_class(stroke.size())] * rates.death.at(middle(graph, stroke));
  }
  const auto place = [&](std::uint32_t v) { return graph.patch(v).position; };
  const auto add = [&](Tally<kSince>& tally, const std::vector<Happening>& what, std::uint32_t v,
                       double rate) { tally.expected[since_class(since(what, place(v), frame))] += rate; };
  for (const auto v : found.inner)
    add(tallies.parting, past.unions, v, rates.split * rates.parting.at(place(v)));
  for (const auto& arm : found.arms)
    add(tallies.parting, past.unions, arm.a, rates.disconnect * rates.parting.at(place(arm.a)));
  const auto add_pair = [&](const Sites::Pair& pair, double rate) {
    add(tallies.uniting, past.partings, pair.a, rate);
    tallies.bridging.expected[gap_class(graph::distance(place(pair.a), place(pair.b)))] += rate;
  };
  for (const auto& pair : found.facing) add_pair(pair, rates.merge);
  for (const auto& pair : found.beside) {
    add_pair(pair, rates.connect);
    tallies.turning.expected[class_of(graph, pair)] += rates.connect;
  }
}

void count(const graph::Event& event, const graph::AttributeGraph& before, const Sites& found,
           const Past& past, Tallies& tallies) {
  const double frame = event.frame;
  if (event.type == EventType::death) ++tallies.death.happened[past.age(event.before.at(0), frame)];
  if (is_parting(event.type))
    ++tallies.parting.happened[since_class(since(past.unions, event.position, frame))];
  if (!is_union(event.type)) return;
  ++tallies.uniting.happened[since_class(since(past.partings, event.position, frame))];
  ++tallies.bridging.happened[gap_class(gap_between(before, event.before.at(0), event.before.at(1)))];
  const auto of = [&](std::uint32_t v) { return before.vertices()[v].subgraph; };
  for (const auto& pair : found.beside)
    if (std::minmax(of(pair.a), of(pair.b)) == std::minmax(event.before.at(0), event.before.at(1)))
      ++tallies.turning.happened[class_of(before, pair)];
}

}  // namespace

std::size_t since_class(double frames) {
  return static_cast<std::size_t>(std::ranges::upper_bound(begins, frames) - begins.begin());
}

std::size_t gap_class(double px) {
  return static_cast<std::size_t>(std::ranges::upper_bound(widths, px) - widths.begin());
}

std::size_t turn_class(double angle) {
  return std::min(kTurns - 1, static_cast<std::size_t>(angle / (std::numbers::pi / 6)));
}

double since(std::span<const Happening> all, graph::Point place, double frame) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& one : all) {
    const graph::Point apart = one.place - place;
    if (graph::dot(apart, apart) <= near * near) least = std::min(least, std::max(0.0, frame - one.frame));
  }
  return least;
}

Circumstances estimate_circumstances(std::span<const graph::MotionGraph> samples,
                                     std::span<const std::vector<graph::Event>> events,
                                     const OperatorRates& rates) {
  Tallies tallies;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Past past;
    auto event = events[i].begin();
    const auto& frames = samples[i].sketch.frames;
    for (std::size_t t = 1; t < frames.size(); ++t) {
      past.forget(static_cast<double>(t));
      const auto& before = frames[t - 1];
      const auto parts = graph::components(before);
      const Sites found = sites(before, parts, rates.reach);
      expect(before, parts, found, past, static_cast<double>(t), rates, tallies);
      const auto first = event;
      for (; event != events[i].end() && event->frame == static_cast<int>(t); ++event)
        count(*event, before, found, past, tallies);
      std::for_each(first, event, [&](const graph::Event& one) { past.note(one); });
    }
  }
  return {tallies.death.relative(),    tallies.parting.relative(), tallies.uniting.relative(),
          tallies.bridging.relative(), tallies.turning.relative(), 1};
}

}  // namespace emberfold::mcmc
