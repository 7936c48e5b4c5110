// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "core/text/check_range.hpp"
#include "graph/matching/assignment.hpp"

namespace emberfold::graph {

namespace {

using Events = std::vector<const Event*>;

/// Counts the pairs of true and found events of one class.
std::size_t hits(const Events& truth, const Events& found, const ScoreOptions& options) {
  // Exceeds any sum of distances, each below 1: hits count before distances.
  const double hit = 1 + static_cast<double>(std::min(truth.size(), found.size()));
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < truth.size(); ++i) {
    for (std::uint32_t j = 0; j < found.size(); ++j) {
      const double frames = std::abs(static_cast<double>(truth[i]->frame) - found[j]->frame);
      const double pixels = distance(truth[i]->position, found[j]->position);
      if (!(frames <= options.frames && pixels <= options.radius)) continue;
      candidates.push_back(
          {i, j, hit - 0.5 * frames / (options.frames + 1) - 0.5 * pixels / (options.radius + 1)});
    }
  }
  return assign(candidates).size();
}

std::string_view four_class(EventType type) {
  switch (type) {
    case EventType::split:
    case EventType::disconnect:
      return "separate";
    case EventType::merge:
    case EventType::connect:
      return "unite";
    default:
      return name(type);
  }
}

template <class NameOf>
std::vector<ClassScore> score_classes(const std::vector<Event>& truth, const std::vector<Event>& found,
                                      const ScoreOptions& options, NameOf name_of) {
  std::map<std::string_view, std::pair<Events, Events>> classes;
  for (const Event& event : truth) classes[name_of(event.type)].first.push_back(&event);
  for (const Event& event : found) classes[name_of(event.type)].second.push_back(&event);
  std::vector<ClassScore> result;
  ClassScore all{"all", truth.size(), found.size(), 0};
  for (const auto& [class_name, events] : classes) {
    const std::size_t hit = hits(events.first, events.second, options);
    result.push_back({std::string(class_name), events.first.size(), events.second.size(), hit});
    all.hit += hit;
  }
  result.push_back(std::move(all));
  return result;
}

double ratio(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

void ScoreOptions::validate() const {
  core::check_fields("ScoreOptions", *this);
}

double ClassScore::precision() const {
  if (found == 0) return in_truth == 0 ? 1 : 0;
  return ratio(hit, found);
}

double ClassScore::recall() const {
  return in_truth == 0 ? 1 : ratio(hit, in_truth);
}

double ClassScore::f1() const {
  return in_truth + found == 0 ? 1 : ratio(2 * hit, in_truth + found);
}

Score score_events(const std::vector<Event>& truth, const std::vector<Event>& found,
                   const ScoreOptions& options) {
  options.validate();
  return {score_classes(truth, found, options, four_class),
          score_classes(truth, found, options, [](EventType type) { return name(type); })};
}

}  // namespace emberfold::graph
