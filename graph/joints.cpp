// SPDX-License-Identifier: Apache-2.0
#include "graph/joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <queue>
#include <tuple>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::graph::detail {

namespace {
constexpr std::uint32_t kNone = ~std::uint32_t{0};
constexpr double kFar = std::numeric_limits<double>::infinity();
}  // namespace

Paths::Paths(const AttributeGraph& graph)
    : graph_(graph),
      distance_(graph.size(), kFar),
      source_(graph.size(), kNone),
      from_(graph.size(), kNone) {}

void Paths::search(std::span<const std::uint32_t> sources) {
  for (const std::uint32_t v : touched_) distance_[v] = kFar, source_[v] = from_[v] = kNone;
  touched_.clear();
  reached_.clear();
  using Entry = std::tuple<double, std::uint32_t, std::uint32_t>;  // distance, source, vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto offer = [&](std::uint32_t v, double length, std::uint32_t source, std::uint32_t from) {
    if (std::tie(length, source) >= std::tie(distance_[v], source_[v])) return;
    if (distance_[v] == kFar) touched_.push_back(v);
    distance_[v] = length;
    source_[v] = source;
    from_[v] = from;
    queue.emplace(length, source, v);
  };
  for (const std::uint32_t v : sources) offer(v, 0, v, v);
  while (!queue.empty()) {
    const auto [length, source, v] = queue.top();
    queue.pop();
    if (length != distance_[v] || source != source_[v]) continue;
    reached_.push_back(v);
    for (const std::uint32_t w : graph_.neighbours(v)) {
      offer(w, length + graph::distance(graph_.patch(v).position, graph_.patch(w).position), source, v);
    }
  }
}

std::vector<std::uint32_t> Paths::way(std::uint32_t vertex) const {
  std::vector<std::uint32_t> result{vertex};
  while (from_[result.back()] != result.back()) result.push_back(from_[result.back()]);
  return result;
}

Point middle(const AttributeGraph& graph, std::span<const std::uint32_t> path) {
  const auto at = [&](std::size_t k) { return graph.patch(path[k]).position; };
  double length = 0;
  for (std::size_t k = 1; k < path.size(); ++k) length += distance(at(k - 1), at(k));
  double left = length / 2;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double step = distance(at(k - 1), at(k));
    if (left <= step && step > 0) return at(k - 1) + (at(k) - at(k - 1)) * (left / step);
    left -= step;
  }
  return at(path.size() - 1);
}

Point component_middle(const AttributeGraph& graph, Paths& paths, std::uint32_t member) {
  const auto farthest = [&](std::uint32_t from) {
    paths.search(std::span(&from, 1));
    std::uint32_t best = from;
    for (const std::uint32_t v : paths.reached()) {
      const double further = paths.distance(v) - paths.distance(best);
      if (further > 0 || (further == 0 && v < best)) best = v;
    }
    return best;
  };
  return middle(graph, paths.way(farthest(farthest(member))));
}

namespace {

/// The parts of a component as they have grown over what lies between them.
class Regions {
 public:
  Regions(const AttributeGraph& graph, Paths& paths, const Labelled& labelled)
      : graph_(graph), paths_(paths) {
    for (const auto& [v, label] : labelled) {
      if (sources_.empty() || sources_.back() != v) {
        sources_.push_back(v);
        labels_.push_back(label);
      }
    }
    paths_.search(sources_);
  }

  [[nodiscard]] std::uint32_t label(std::uint32_t v) const {
    const auto at = std::lower_bound(sources_.begin(), sources_.end(), paths_.source(v));
    return labels_[static_cast<std::size_t>(at - sources_.begin())];
  }

  /// Whether the part of this label ends where `path` leaves it at its front, and in which direction.
  [[nodiscard]] std::optional<Point> end_tangent(std::uint32_t part,
                                                 std::span<const std::uint32_t> path) const;

 private:
  const AttributeGraph& graph_;
  Paths& paths_;
  std::vector<std::uint32_t> sources_, labels_;
};

std::optional<Point> Regions::end_tangent(std::uint32_t part, std::span<const std::uint32_t> path) const {
  constexpr double kReach = 15;  // px: three patches or so, that noise does not turn it
  const std::uint32_t end = path[0];
  const Point tip = graph_.patch(end).position;
  const Point ahead = path.size() > 1 ? graph_.patch(path[1]).position - tip : Point{};
  std::uint32_t v = end, previous = path.size() > 1 ? path[1] : kNone;
  double walked = 0;
  while (walked < kReach) {
    std::uint32_t next = kNone;
    double straightest = -2;
    for (const std::uint32_t w : graph_.neighbours(v)) {
      if (w == previous || label(w) != part) continue;
      if (v == end && next != kNone) return std::nullopt;  // the part goes on to both sides
      const Point back = tip - graph_.patch(w).position;
      const Point so_far = v == end ? back : tip - graph_.patch(v).position;
      const double straight =
          norm(back) > 0 && norm(so_far) > 0 ? dot(back, so_far) / (norm(back) * norm(so_far)) : 0;
      if (straight > straightest) next = w, straightest = straight;
    }
    if (next == kNone || next == end) break;
    walked += distance(graph_.patch(v).position, graph_.patch(next).position);
    previous = v;
    v = next;
  }
  const Point chord = tip - graph_.patch(v).position;
  if (norm(chord) > 0) return chord * (1 / norm(chord));
  const double theta = graph_.patch(end).theta;
  const Point along{std::cos(theta), std::sin(theta)};
  return dot(along, ahead) < 0 ? along * -1 : along;
}

/// Whether the parts at both ends of the path continue each other.
bool continues(const AttributeGraph& graph, const Regions& regions, std::span<const std::uint32_t> path,
               std::uint32_t part_front, std::uint32_t part_back) {
  const double kStraight = std::cos(std::numbers::pi / 6);
  const auto out = regions.end_tangent(part_front, path);
  const std::vector<std::uint32_t> reversed(path.rbegin(), path.rend());
  const auto in = regions.end_tangent(part_back, reversed);
  if (!out || !in) return false;
  const Point gap = graph.patch(path.back()).position - graph.patch(path.front()).position;
  if (norm(gap) == 0) return dot(*out, *in * -1) > kStraight;
  return dot(*out, gap) > kStraight * norm(gap) && dot(*in * -1, gap) > kStraight * norm(gap);
}

struct Meeting {
  double length = 0;
  std::uint32_t a = 0, b = 0;  ///< the vertices at which two regions meet: an edge, or one vertex in both
  std::uint32_t label_a = 0, label_b = 0;
};

std::vector<Meeting> meetings(const AttributeGraph& graph, const Paths& paths, const Regions& regions,
                              const Labelled& labelled) {
  std::vector<Meeting> result;
  for (std::size_t k = 1; k < labelled.size(); ++k) {
    const auto& [v, label] = labelled[k];
    if (labelled[k - 1].first == v) result.push_back({0, v, v, labelled[k - 1].second, label});
  }
  for (const std::uint32_t a : paths.reached()) {
    for (const std::uint32_t b : graph.neighbours(a)) {
      if (b < a) continue;
      const std::uint32_t label_a = regions.label(a), label_b = regions.label(b);
      if (label_a == label_b) continue;
      const double step = distance(graph.patch(a).position, graph.patch(b).position);
      result.push_back({paths.distance(a) + step + paths.distance(b), a, b, label_a, label_b});
    }
  }
  std::sort(result.begin(), result.end(), [](const Meeting& p, const Meeting& q) {
    return std::tie(p.length, p.a, p.b, p.label_a) < std::tie(q.length, q.a, q.b, q.label_a);
  });
  return result;
}

}  // namespace

std::vector<Joint> joints(const AttributeGraph& graph, Paths& paths, const Labelled& labelled) {
  Labelled parts = labelled;
  std::sort(parts.begin(), parts.end());
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  std::vector<std::uint32_t> labels;
  for (const auto& [v, label] : parts) labels.push_back(label);
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  const auto number = [&](std::uint32_t label) {
    return static_cast<std::size_t>(std::lower_bound(labels.begin(), labels.end(), label) - labels.begin());
  };

  std::vector<std::size_t> rank(labels.size()), parent(labels.size());
  boost::disjoint_sets joined(rank.data(), parent.data());
  for (std::size_t k = 0; k < labels.size(); ++k) joined.make_set(k);

  const Regions regions(graph, paths, parts);
  std::vector<Joint> result;
  for (const Meeting& meeting : meetings(graph, paths, regions, parts)) {
    const std::size_t a = joined.find_set(number(meeting.label_a)),
                      b = joined.find_set(number(meeting.label_b));
    if (a == b) continue;
    joined.link(a, b);
    std::vector<std::uint32_t> path = paths.way(meeting.a);
    std::reverse(path.begin(), path.end());
    if (meeting.b != meeting.a) {
      const auto rest = paths.way(meeting.b);
      path.insert(path.end(), rest.begin(), rest.end());
    }
    const auto [low, high] = std::minmax(meeting.label_a, meeting.label_b);
    result.push_back(
        {low, high, middle(graph, path), continues(graph, regions, path, meeting.label_a, meeting.label_b)});
  }
  return result;
}

}  // namespace emberfold::graph::detail
