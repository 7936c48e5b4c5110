// SPDX-License-Identifier: Apache-2.0
#include "graph/score.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

#include "core/error.hpp"
#include "graph/assignment.hpp"

namespace emberfold::graph {

namespace {

using Events = std::vector<const Event*>;

struct Apart {
  double frames = 0, pixels = 0;
};

Apart apart(const Event& a, const Event& b) {
  return {std::abs(static_cast<double>(a.frame) - b.frame), distance(a.position, b.position)};
}

/// Of the events of one class: how many pair up.
std::size_t hits(const Events& truth, const Events& found, const ScoreOptions& options) {
  const auto near = [&](Apart d) { return d.frames <= options.frames && d.pixels <= options.radius; };
  // What lies out of reach of each other is assigned apart: the sum is the same and the problems are small.
  const std::size_t n = truth.size(), m = found.size();
  std::vector<std::size_t> rank(n + m), parent(n + m);
  boost::disjoint_sets groups(rank.data(), parent.data());
  for (std::size_t k = 0; k < n + m; ++k) groups.make_set(k);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      if (near(apart(*truth[i], *found[j]))) groups.union_set(i, n + j);
    }
  }
  std::map<std::size_t, std::pair<Events, Events>> by_group;
  for (std::size_t i = 0; i < n; ++i) by_group[groups.find_set(i)].first.push_back(truth[i]);
  for (std::size_t j = 0; j < m; ++j) by_group[groups.find_set(n + j)].second.push_back(found[j]);

  std::size_t count = 0;
  std::vector<double> cost;
  for (const auto& [root, group] : by_group) {
    const auto& [rows, columns] = group;
    // Above any sum of the other costs, each below 1: one hit more is worth any distance.
    const double miss = 1 + static_cast<double>(std::min(rows.size(), columns.size()));
    cost.clear();
    for (const Event* t : rows) {
      for (const Event* f : columns) {
        const Apart d = apart(*t, *f);
        cost.push_back(near(d) ? 0.5 * d.frames / (options.frames + 1) + 0.5 * d.pixels / (options.radius + 1)
                               : miss);
      }
    }
    const auto column_of = assign(rows.size(), columns.size(), cost);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (column_of[i] != kUnassigned && near(apart(*rows[i], *columns[column_of[i]]))) ++count;
    }
  }
  return count;
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
  const auto check = [](const char* field, double value) {
    if (!(value >= 0) || !std::isfinite(value)) {
      throw core::InputError("score: " + std::string(field) + " is " + std::to_string(value) +
                             ", allowed is a finite number ≥ 0");
    }
  };
  check("frames", frames);
  check("radius", radius);
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
