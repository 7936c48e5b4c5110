// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_pairs.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "graph/events/event_family.hpp"

namespace emberfold::pipeline {

namespace {

using graph::detail::family;
using graph::detail::Family;

constexpr int kBriefLife = 2, kBriefJoint = 1;  // frames
constexpr double kBriefPlace = 6;               // px
constexpr int kRivalFrames = 2;
constexpr double kRivalPlace = 20;  // px

/// Visits each pair of events at most `frames` frames apart, the earlier one first.
template <class Visit>
void each_pair(std::span<const graph::Event> events, int frames, const Visit& visit) {
  std::vector<std::size_t> order(events.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return events[k].frame; });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (events[order[j]].frame - events[order[i]].frame > frames) break;
      visit(order[i], order[j]);
    }
}

bool are_brief(const graph::Event& first, const graph::Event& second) {
  const Family a = family(first.type), b = family(second.type);
  const int apart = second.frame - first.frame;
  if (a == Family::birth && b == Family::death) return apart >= 1 && apart <= kBriefLife;
  return ((a == Family::unite && b == Family::separate) || (a == Family::separate && b == Family::unite)) &&
         apart <= kBriefJoint;
}

bool are_rivals(Family a, Family b) {
  return (a == Family::death && b == Family::unite) || (a == Family::birth && b == Family::separate);
}

}  // namespace

std::vector<mcmc::ChangePair> brief_pairs(std::span<const graph::Event> events) {
  std::vector<std::tuple<int, double, std::size_t, std::size_t>> near;  // frames and px apart, events
  each_pair(events, kBriefLife, [&](std::size_t a, std::size_t b) {
    if (!are_brief(events[a], events[b])) return;
    const double apart = distance(events[a].position, events[b].position);
    if (apart <= kBriefPlace) near.emplace_back(events[b].frame - events[a].frame, apart, a, b);
  });
  std::ranges::sort(near);
  std::vector<bool> is_taken(events.size(), false);
  std::vector<mcmc::ChangePair> pairs;
  for (const auto& [frames, apart, a, b] : near) {
    if (is_taken[a] || is_taken[b]) continue;
    is_taken[a] = is_taken[b] = true;
    pairs.push_back({a, b});
  }
  return pairs;
}

std::vector<mcmc::ChangePair> rival_pairs(std::span<const graph::Event> events) {
  std::vector<mcmc::ChangePair> pairs;
  each_pair(events, kRivalFrames, [&](std::size_t a, std::size_t b) {
    const Family of_a = family(events[a].type), of_b = family(events[b].type);
    if ((are_rivals(of_a, of_b) || are_rivals(of_b, of_a)) &&
        distance(events[a].position, events[b].position) <= kRivalPlace)
      pairs.push_back({a, b});
  });
  return pairs;
}

}  // namespace emberfold::pipeline
