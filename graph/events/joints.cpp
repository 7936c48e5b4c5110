// SPDX-License-Identifier: Apache-2.0
#include "graph/events/joints.hpp"

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
constexpr double kNearEnd = 10;   // px: two patches
constexpr double kTurnPrior = 8;  // px²: (0.085 rad noise of a step / 0.03 rad a px bend of strokes)²
constexpr double kStraight = std::numbers::pi / 6;  // rad: largest turn at either end of a gap in one line
}  // namespace

ShortestPaths::ShortestPaths(const AttributeGraph& graph)
    : graph_(graph),
      distance_(graph.size(), kFar),
      source_(graph.size(), kNone),
      from_(graph.size(), kNone) {}

void ShortestPaths::search(std::span<const std::uint32_t> sources) {
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

std::vector<std::uint32_t> ShortestPaths::path_to_source(std::uint32_t vertex) const {
  std::vector<std::uint32_t> result{vertex};
  while (from_[result.back()] != result.back()) result.push_back(from_[result.back()]);
  return result;
}

Point path_middle(const AttributeGraph& graph, std::span<const std::uint32_t> path) {
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

std::vector<std::uint32_t> longest_path(ShortestPaths& paths, std::uint32_t member) {
  const auto farthest = [&](std::uint32_t from) {
    paths.search(std::span(&from, 1));
    std::uint32_t best = from;
    for (const std::uint32_t v : paths.reached()) {
      const double further = paths.distance(v) - paths.distance(best);
      if (further > 0 || (further == 0 && v < best)) best = v;
    }
    return best;
  };
  return paths.path_to_source(farthest(farthest(member)));
}

Point component_middle(const AttributeGraph& graph, ShortestPaths& paths, std::uint32_t member) {
  return path_middle(graph, longest_path(paths, member));
}

std::vector<bool> find_vertices_near_ends(const AttributeGraph& graph, ShortestPaths& paths) {
  std::vector<std::uint32_t> ends;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (graph.degree(v) <= 1) ends.push_back(v);
  }
  paths.search(ends);
  std::vector<bool> result(graph.size(), false);
  for (const std::uint32_t v : paths.reached()) result[v] = paths.distance(v) <= kNearEnd;
  return result;
}

Point tip_direction(std::span<const Point> way) {
  // Ridge regression of the direction of the steps on arc length, evaluated at the tip. The penalty on the
  // curvature is the variance of the noise over that of the curvature.
  const Point chord = way.front() - way.back();
  if (norm(chord) == 0) return {};
  double n = 0, arc = 0, sum_s = 0, sum_a = 0, sum_ss = 0, sum_sa = 0;
  for (std::size_t k = 1; k < way.size(); ++k) {
    const Point step = way[k - 1] - way[k];
    const double s = arc + norm(step) / 2;
    const double angle = std::atan2(chord.x * step.y - chord.y * step.x, dot(chord, step));
    arc += norm(step);
    n += 1, sum_s += s, sum_a += angle, sum_ss += s * s, sum_sa += s * angle;
  }
  const double slope = (sum_sa - sum_s * sum_a / n) / (sum_ss - sum_s * sum_s / n + kTurnPrior);
  const double turn = sum_a / n - slope * sum_s / n;
  const Point unit = chord * (1 / norm(chord));
  return {unit.x * std::cos(turn) - unit.y * std::sin(turn),
          unit.x * std::sin(turn) + unit.y * std::cos(turn)};
}

namespace {

/// The parts of a component, each grown over the unlabelled vertices nearest to it.
class GrownParts {
 public:
  /// `vertices`: sorted by vertex, then label.
  GrownParts(const AttributeGraph& graph, ShortestPaths& paths, std::span<const PartVertex> vertices)
      : graph_(graph), paths_(paths), vertices_(vertices) {
    for (const PartVertex& member : vertices) {
      if (sources_.empty() || sources_.back() != member.vertex) {
        sources_.push_back(member.vertex);
        labels_.push_back(member.label);
      }
    }
    paths_.search(sources_);
  }

  [[nodiscard]] std::uint32_t label(std::uint32_t v) const {
    const auto at = std::lower_bound(sources_.begin(), sources_.end(), paths_.source(v));
    return labels_[static_cast<std::size_t>(at - sources_.begin())];
  }

  /// Returns the direction in which the part ends at the front of `path`, if it ends there.
  [[nodiscard]] std::optional<Point> end_tangent(std::uint32_t part,
                                                 std::span<const std::uint32_t> path) const;

 private:
  [[nodiscard]] bool ends_at(std::uint32_t v, std::uint32_t part) const;
  /// Walks from the front of `path` into the part as far as a tangent needs; empty if the part does not end
  /// here.
  [[nodiscard]] std::vector<std::uint32_t> path_into_part(std::uint32_t part,
                                                          std::span<const std::uint32_t> path) const;

  const AttributeGraph& graph_;
  ShortestPaths& paths_;
  std::span<const PartVertex> vertices_;
  std::vector<std::uint32_t> sources_, labels_;
};

bool GrownParts::ends_at(std::uint32_t v, std::uint32_t part) const {
  const auto found = std::lower_bound(
      vertices_.begin(), vertices_.end(), std::pair(v, part),
      [](const PartVertex& t, const auto& key) { return std::pair(t.vertex, t.label) < key; });
  return found != vertices_.end() && found->vertex == v && found->label == part && found->at_end;
}

std::vector<std::uint32_t> GrownParts::path_into_part(std::uint32_t part,
                                                      std::span<const std::uint32_t> path) const {
  std::vector<std::uint32_t> way{path[0]};
  std::uint32_t previous = path.size() > 1 ? path[1] : kNone;
  for (double walked = 0; walked < kTipReach;) {
    const std::uint32_t v = way.back();
    const Point here = graph_.patch(v).position;
    const Point heading = here - (way.size() > 1 ? graph_.patch(way[way.size() - 2]).position : here);
    std::uint32_t next = kNone;
    double straightest = -2;
    for (const std::uint32_t w : graph_.neighbours(v)) {
      if (w == previous || label(w) != part) continue;
      if (way.size() == 1 && next != kNone) return {};  // the part continues on both sides
      const Point step = graph_.patch(w).position - here;
      const double lengths = norm(step) * norm(heading);
      const double straight = lengths > 0 ? dot(step, heading) / lengths : 0;
      if (straight > straightest) next = w, straightest = straight;
    }
    if (next == kNone || std::find(way.begin(), way.end(), next) != way.end()) break;
    walked += distance(here, graph_.patch(next).position);
    previous = v;
    way.push_back(next);
  }
  return way;
}

std::optional<Point> GrownParts::end_tangent(std::uint32_t part, std::span<const std::uint32_t> path) const {
  const auto way = ends_at(path[0], part) ? path_into_part(part, path) : std::vector<std::uint32_t>{};
  if (way.empty()) return std::nullopt;
  std::vector<Point> points;
  for (const std::uint32_t v : way) points.push_back(graph_.patch(v).position);
  if (const Point out = tip_direction(points); norm(out) > 0) return out;
  const double theta = graph_.patch(way.front()).theta;
  const Point along{std::cos(theta), std::sin(theta)};
  const Point ahead = path.size() > 1 ? graph_.patch(path[1]).position - points.front() : Point{};
  return dot(along, ahead) < 0 ? along * -1 : along;
}

/// Returns whether the parts at both ends of the path continue each other.
bool is_continuation(const AttributeGraph& graph, const GrownParts& regions,
                     std::span<const std::uint32_t> path, std::uint32_t part_front, std::uint32_t part_back) {
  const double least = std::cos(kStraight);
  const auto out = regions.end_tangent(part_front, path);
  const std::vector<std::uint32_t> reversed(path.rbegin(), path.rend());
  const auto in = regions.end_tangent(part_back, reversed);
  if (!out || !in) return false;
  const Point gap = graph.patch(path.back()).position - graph.patch(path.front()).position;
  if (norm(gap) == 0) return dot(*out, *in * -1) > least;
  return dot(*out, gap) > least * norm(gap) && dot(*in * -1, gap) > least * norm(gap);
}

/// A place where two grown parts meet.
struct Meeting {
  double length = 0;           ///< px, of the path between the parts
  std::uint32_t a = 0, b = 0;  ///< the ends of the edge between them, or one vertex of both
  std::uint32_t label_a = 0, label_b = 0;
};

std::vector<Meeting> find_meetings(const AttributeGraph& graph, const ShortestPaths& paths,
                                   const GrownParts& regions, std::span<const PartVertex> vertices) {
  std::vector<Meeting> result;
  for (std::size_t k = 1; k < vertices.size(); ++k) {
    const std::uint32_t v = vertices[k].vertex;
    if (vertices[k - 1].vertex == v) result.push_back({0, v, v, vertices[k - 1].label, vertices[k].label});
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

std::vector<Joint> find_joints(const AttributeGraph& graph, ShortestPaths& paths,
                               std::vector<PartVertex> vertices) {
  std::sort(vertices.begin(), vertices.end(), [](const PartVertex& a, const PartVertex& b) {
    return std::tuple(a.vertex, a.label, !a.at_end) < std::tuple(b.vertex, b.label, !b.at_end);
  });
  const auto same = [](const PartVertex& a, const PartVertex& b) {
    return a.vertex == b.vertex && a.label == b.label;
  };
  vertices.erase(std::unique(vertices.begin(), vertices.end(), same), vertices.end());
  std::vector<std::uint32_t> labels;
  for (const PartVertex& member : vertices) labels.push_back(member.label);
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  const auto number = [&](std::uint32_t label) {
    return static_cast<std::size_t>(std::lower_bound(labels.begin(), labels.end(), label) - labels.begin());
  };

  std::vector<std::size_t> rank(labels.size()), parent(labels.size());
  boost::disjoint_sets joined(rank.data(), parent.data());
  for (std::size_t k = 0; k < labels.size(); ++k) joined.make_set(k);

  const GrownParts regions(graph, paths, vertices);
  std::vector<Joint> result;
  for (const Meeting& meeting : find_meetings(graph, paths, regions, vertices)) {
    const std::size_t a = joined.find_set(number(meeting.label_a)),
                      b = joined.find_set(number(meeting.label_b));
    if (a == b) continue;
    joined.link(a, b);
    std::vector<std::uint32_t> path = paths.path_to_source(meeting.a);
    std::reverse(path.begin(), path.end());
    if (meeting.b != meeting.a) {
      const auto rest = paths.path_to_source(meeting.b);
      path.insert(path.end(), rest.begin(), rest.end());
    }
    const auto [low, high] = std::minmax(meeting.label_a, meeting.label_b);
    const Point middle = path_middle(graph, path);
    const bool continues = is_continuation(graph, regions, path, meeting.label_a, meeting.label_b);
    result.push_back({low, high, middle, continues, std::move(path)});
  }
  return result;
}

}  // namespace emberfold::graph::detail
