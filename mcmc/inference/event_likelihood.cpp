// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/event_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "mcmc/learning/operator_sites.hpp"
#include "mcmc/learning/stroke_places.hpp"

namespace emberfold::mcmc::detail {

namespace {

using graph::EventType;
using graph::SubgraphId;

constexpr double kLeastDeath = 1e-6, kMostDeath = 0.95;  // of a stroke in a gap

/// A place at which a class of event can happen, the strokes concerned, and how often it does.
struct RatedSite {
  graph::Point place;
  SubgraphId first, second;  ///< of a pair in order; equal where it is one stroke
  double rate = 0;
};

/// The frame before a gap and what rates depend on.
struct RatedFrame {
  const MotionModel& model;
  const graph::AttributeGraph& graph;
  const EventHistory& history;
  double frame = 0;
  graph::Components parts = graph::components(graph);
  OperatorSites sites = find_sites(graph, parts, model.rates.reach);

  [[nodiscard]] double after(const std::array<double, kElapsedClasses>& multiples, double frames) const {
    return multiples[elapsed_class(frames * model.rates.modifiers.pace)];
  }
  [[nodiscard]] graph::Point place(std::uint32_t v) const { return graph.patch(v).position; }
  [[nodiscard]] SubgraphId stroke(std::uint32_t v) const { return graph.vertices()[v].subgraph; }

  [[nodiscard]] RatedSite separation(std::uint32_t v, double rate) const {
    const auto& rates = model.rates;
    return {place(v), stroke(v), stroke(v),
            rate * rates.separation.at(place(v)) *
                after(rates.modifiers.separation, frames_since(history.unions, place(v), frame))};
  }
  [[nodiscard]] RatedSite unification(const OperatorSites::Pair& pair, double rate) const {
    const auto& modifiers = model.rates.modifiers;
    const auto [low, high] = std::minmax({stroke(pair.a), stroke(pair.b)});
    return {(place(pair.a) + place(pair.b)) * 0.5, low, high,
            rate * after(modifiers.unification, frames_since(history.separations, place(pair.a), frame)) *
                modifiers.bridging[gap_class(graph::distance(place(pair.a), place(pair.b)))]};
  }
};

std::vector<RatedSite> rated_sites(const RatedFrame& frame, EventType type) {
  const auto& rates = frame.model.rates;
  std::vector<RatedSite> result;
  if (type == EventType::split)
    for (const auto v : frame.sites.split_sites) result.push_back(frame.separation(v, rates.split));
  if (type == EventType::disconnect)
    for (const auto& arm : frame.sites.disconnect_sites)
      result.push_back(frame.separation(arm.a, rates.disconnect));
  if (type == EventType::merge)
    for (const auto& pair : frame.sites.merge_sites) result.push_back(frame.unification(pair, rates.merge));
  if (type == EventType::connect)
    for (const auto& pair : frame.sites.connect_sites)
      result.push_back(frame.unification(
          pair, rates.connect * rates.modifiers.turning[turn_class(turn_angle_towards(frame.graph, pair))]));
  return result;
}

bool concerns(const RatedSite& site, const graph::Event& event) {
  const auto& strokes = event.before;
  if (strokes.empty()) return false;
  const auto [low, high] = std::minmax_element(strokes.begin(), strokes.end());
  return site.first == *low && site.second == *high;
}

// The rate at the nearest site of the event's strokes; elsewhere, if there is none or it has no events.
double rate_at(const std::vector<RatedSite>& sites, const graph::Event& event) {
  double nearest = std::numeric_limits<double>::infinity(), rate = 0;
  for (const auto& site : sites) {
    const double off = graph::distance(site.place, event.position);
    if (concerns(site, event) && off < nearest) nearest = off, rate = site.rate;
  }
  return rate > 0 ? rate : kElsewhere;
}

double log_of_sites(const RatedFrame& frame, EventType type, std::span<const graph::Event> events) {
  const auto sites = rated_sites(frame, type);
  double sum = -kElsewhere;
  for (const auto& site : sites) sum -= site.rate;
  for (const auto& event : events)
    if (event.type == type) sum += std::log(rate_at(sites, event));
  return sum;
}

double log_of_deaths(const RatedFrame& frame, std::span<const graph::Event> events) {
  std::set<SubgraphId> died;
  for (const auto& event : events)
    if (event.type == EventType::death) died.insert(event.before.at(0));
  const auto& rates = frame.model.rates;
  double sum = 0;
  for (const auto& stroke : vertices_by_stroke(frame.parts)) {
    const SubgraphId identity = frame.stroke(stroke[0]);
    const double rate = rates.death_by_size[size_class(stroke.size())] *
                        rates.death.at(stroke_middle(frame.graph, stroke)) *
                        frame.after(rates.modifiers.death, frame.history.age(identity, frame.frame));
    const double chance = std::clamp(rate, kLeastDeath, kMostDeath);
    sum += died.contains(identity) ? std::log(chance) : std::log1p(-chance);
  }
  return sum;
}

double log_of_births(const MotionModel& model, const graph::AttributeGraph& after,
                     std::span<const graph::Event> events) {
  constexpr double kLeastShare = 1e-3;
  const auto& map = model.rates.birth;
  const double elsewhere = kElsewhere / (double(model.width) * model.height);
  std::map<SubgraphId, std::size_t> sizes;
  for (const auto& vertex : after.vertices()) ++sizes[vertex.subgraph];
  double sum = -kElsewhere - std::accumulate(map.values.begin(), map.values.end(), 0.0) * map.cell * map.cell;
  for (const auto& event : events) {
    if (event.type != EventType::birth) continue;
    const double share = model.rates.birth_by_size[size_class(sizes[event.after.at(0)])];
    sum += std::log(map.at(event.position) + elsewhere) +
           std::log((share + kLeastShare) / (1 + kSizeClasses * kLeastShare));
  }
  return sum;
}

}  // namespace

std::array<double, 6> event_log_probabilities(const MotionModel& model, const graph::AttributeGraph& before,
                                              const graph::AttributeGraph& after,
                                              std::span<const graph::Event> events,
                                              const EventHistory& history, int frame) {
  const RatedFrame rated{model, before, history, static_cast<double>(frame)};
  std::array<double, 6> result{};
  for (const EventType type : graph::all_event_types())
    result[static_cast<std::size_t>(type)] = type == EventType::birth   ? log_of_births(model, after, events)
                                             : type == EventType::death ? log_of_deaths(rated, events)
                                                                        : log_of_sites(rated, type, events);
  return result;
}

}  // namespace emberfold::mcmc::detail
