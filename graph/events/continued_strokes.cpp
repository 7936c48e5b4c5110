// SPDX-License-Identifier: Apache-2.0
#include "graph/events/continued_strokes.hpp"

#include <algorithm>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "graph/matching/frame_links.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr std::size_t kLongestAbsence = 10;              // frames from the last to the first
constexpr double kSamePlace = 8;                         // px between counterparts
constexpr double kSameDirection = std::numbers::pi / 6;  // between counterparts
constexpr double kLeastShare = 0.5;  // of the smaller one's patches that have a counterpart

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// An end and a beginning of strokes, in their frames.
struct Gap {
  SubgraphId ending, beginning;
  std::size_t from = 0, to = 0;            ///< frames
  std::vector<std::uint32_t> last, first;  ///< patches
  Pairs counterparts;                      ///< of the patches of the last and the first frame, one to one
  double share = 0;                        ///< of the smaller one's patches
};

/// Finds the counterparts of two strokes, the nearest first, where the first one has moved by `way`.
Pairs counterparts(const AttributeGraph& a, const AttributeGraph& b, const Gap& gap, Point way) {
  std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> near;
  for (const std::uint32_t i : gap.last)
    for (const std::uint32_t j : gap.first) {
      const Patch &p = a.patch(i), &q = b.patch(j);
      const double distance_left = distance(p.position + way, q.position);
      if (distance_left <= kSamePlace && same_kind(p, q) &&
          orientation_difference(p.theta, q.theta) <= kSameDirection)
        near.emplace_back(distance_left, i, j);
    }
  std::ranges::sort(near);
  std::set<std::uint32_t> of_a, of_b;
  Pairs pairs;
  for (const auto& [left, i, j] : near)
    if (!of_a.contains(i) && !of_b.contains(j)) of_a.insert(i), of_b.insert(j), pairs.push_back({i, j});
  return pairs;
}

/// Returns the gaps that can be closed, in the order in which they are.
std::vector<Gap> find_gaps(const MotionGraph& motion, const std::map<SubgraphId, Life>& lives) {
  std::multimap<std::size_t, SubgraphId> beginnings;
  for (const auto& [stroke, life] : lives)
    if (!life.begins && !life.comes_in) beginnings.emplace(life.first, stroke);
  std::vector<Gap> gaps;
  for (const auto& [stroke, life] : lives) {
    if (life.ends || life.goes_out) continue;
    const Point goes = mean_displacement(motion, stroke, life.last - (life.last > life.first), life.last);
    const AttributeGraph& before = motion.sketch.frames[life.last];
    const auto patches = vertices_of(before, stroke);
    const auto until = beginnings.upper_bound(life.last + (life.is_thing() ? 1 : kLongestAbsence));
    for (auto next = beginnings.upper_bound(life.last); next != until; ++next) {
      const Life& other = lives.at(next->second);
      if (other.is_thing() && other.first > life.last + 1) continue;
      const AttributeGraph& after = motion.sketch.frames[other.first];
      Gap gap{stroke, next->second, life.last, other.first, patches, vertices_of(after, next->second), {}, 0};
      const Point comes =
          mean_displacement(motion, next->second, other.first, other.first + (other.last > other.first));
      const Point way = (goes + comes) * (0.5 * static_cast<double>(gap.to - gap.from));
      gap.counterparts = counterparts(before, after, gap, way);
      gap.share = static_cast<double>(gap.counterparts.size()) /
                  static_cast<double>(std::min(gap.last.size(), gap.first.size()));
      if (gap.share >= kLeastShare) gaps.push_back(std::move(gap));
    }
  }
  std::ranges::stable_sort(gaps, [](const Gap& a, const Gap& b) {
    return std::tuple(a.to - a.from, -a.share) < std::tuple(b.to - b.from, -b.share);
  });
  return gaps;
}

/// Adds patches to the frames of a motion graph, and links, by vertex index.
class Additions {
 public:
  explicit Additions(const MotionGraph& motion)
      : motion_(motion),
        vertices_(motion.sketch.frames.size()),
        edges_(vertices_.size()),
        links_(vertices_.size()),
        unlinked_(vertices_.size()) {}

  /// Copies a stroke of frame `from` into frame `to`, moved by `way`; returns its vertices' indices there.
  std::vector<std::uint32_t> copy(std::size_t from, std::span<const std::uint32_t> stroke, std::size_t to,
                                  Point way) {
    const AttributeGraph& graph = motion_.sketch.frames[from];
    std::vector<std::uint32_t> copies;
    for (const std::uint32_t v : stroke) {
      copies.push_back(static_cast<std::uint32_t>(motion_.sketch.frames[to].size() + vertices_[to].size()));
      vertices_[to].push_back(graph.vertices()[v]);
      vertices_[to].back().patch.position = vertices_[to].back().patch.position + way;
    }
    for (std::size_t k = 0; k < stroke.size(); ++k)
      for (const std::uint32_t w : graph.neighbours(stroke[k])) {
        const auto at = std::ranges::lower_bound(stroke, w);
        if (w > stroke[k] && at != stroke.end() && *at == w)
          edges_[to].push_back({copies[k], copies[static_cast<std::size_t>(at - stroke.begin())]});
      }
    return copies;
  }
  /// Removes the links from patches of the frame before, and those to patches of this frame.
  void unlink(std::size_t frame, std::span<const std::uint32_t> before,
              std::span<const std::uint32_t> after) {
    for (const std::uint32_t i : before) unlinked_[frame].first.insert(i);
    for (const std::uint32_t j : after) unlinked_[frame].second.insert(j);
  }
  void link(std::size_t frame, std::uint32_t before, std::uint32_t after) {
    links_[frame].push_back({before, after});
  }
  /// Returns the motion graph with what was added, strokes renamed.
  [[nodiscard]] MotionGraph motion(const std::map<SubgraphId, SubgraphId>& became) const {
    MotionGraph result;
    result.sketch = {motion_.sketch.width, motion_.sketch.height, motion_.sketch.fps, {}};
    result.links.resize(motion_.links.size());
    for (std::size_t t = 0; t < vertices_.size(); ++t) {
      result.sketch.append(frame(t, became));
      if (t > 0) result.links[t] = links(t, result.sketch.frames[t - 1], result.sketch.frames[t]);
    }
    return result;
  }

 private:
  [[nodiscard]] AttributeGraph frame(std::size_t t, const std::map<SubgraphId, SubgraphId>& became) const {
    const AttributeGraph& old = motion_.sketch.frames[t];
    std::vector<Vertex> vertices(old.vertices().begin(), old.vertices().end());
    vertices.insert(vertices.end(), vertices_[t].begin(), vertices_[t].end());
    std::vector<Edge> edges;
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      vertices[v].id = {v};
      const auto at = became.find(vertices[v].subgraph);
      if (at != became.end()) vertices[v].subgraph = at->second;
    }
    for (const Edge& edge : old.edges())
      edges.push_back({{static_cast<std::uint32_t>(old.index_of(edge.a))},
                       {static_cast<std::uint32_t>(old.index_of(edge.b))}});
    for (const auto& [a, b] : edges_[t]) edges.push_back({{a}, {b}});
    return {std::move(vertices), std::move(edges), old.memory()};
  }
  [[nodiscard]] std::vector<Link> links(std::size_t t, const AttributeGraph& before,
                                        const AttributeGraph& after) const {
    const auto &a = motion_.sketch.frames[t - 1], &b = motion_.sketch.frames[t];
    std::vector<Link> result;
    const auto add = [&](std::size_t i, std::size_t j) {
      result.push_back({before.vertices()[i].id, after.vertices()[j].id});
    };
    for (const Link& link : motion_.links[t]) {
      const auto i = static_cast<std::uint32_t>(a.index_of(link.before)),
                 j = static_cast<std::uint32_t>(b.index_of(link.after));
      if (!unlinked_[t].first.contains(i) && !unlinked_[t].second.contains(j)) add(i, j);
    }
    for (const auto& [i, j] : links_[t]) add(i, j);
    std::ranges::sort(result);
    return result;
  }

  const MotionGraph& motion_;
  std::vector<std::vector<Vertex>> vertices_;
  std::vector<Pairs> edges_, links_;  // of each frame
  std::vector<std::pair<std::set<std::uint32_t>, std::set<std::uint32_t>>> unlinked_;
};

/// Fills a gap: the ending stroke moves on up to the middle, from there on the beginning one does.
void close(const MotionGraph& motion, const Gap& gap, Additions& additions) {
  const AttributeGraph &before = motion.sketch.frames[gap.from], &after = motion.sketch.frames[gap.to];
  Point way;
  for (const auto& [i, j] : gap.counterparts)
    way = way + (after.patch(j).position - before.patch(i).position);
  way = way * (1 / static_cast<double>(gap.counterparts.size()));
  const auto length = static_cast<double>(gap.to - gap.from);
  const std::size_t middle = (gap.from + gap.to) / 2;
  // Links from the end to other strokes, or from other strokes to the beginning, are not believed.
  additions.unlink(gap.from + 1, gap.last, {});
  additions.unlink(gap.to, {}, gap.first);
  std::vector<std::uint32_t> last = gap.last, first = gap.first;
  for (std::size_t t = gap.from + 1; t <= middle; ++t) {
    auto next = additions.copy(gap.from, gap.last, t, way * (static_cast<double>(t - gap.from) / length));
    for (std::size_t k = 0; k < next.size(); ++k) additions.link(t, last[k], next[k]);
    last = std::move(next);
  }
  for (std::size_t t = gap.to - 1; t > middle; --t) {
    auto next = additions.copy(gap.to, gap.first, t, way * (-static_cast<double>(gap.to - t) / length));
    for (std::size_t k = 0; k < next.size(); ++k) additions.link(t + 1, next[k], first[k]);
    first = std::move(next);
  }
  for (const auto& [i, j] : gap.counterparts)
    additions.link(
        middle + 1, last[static_cast<std::size_t>(std::ranges::lower_bound(gap.last, i) - gap.last.begin())],
        first[static_cast<std::size_t>(std::ranges::lower_bound(gap.first, j) - gap.first.begin())]);
}

}  // namespace

std::vector<std::pair<SubgraphId, SubgraphId>> possible_gaps(const MotionGraph& motion,
                                                             const std::map<SubgraphId, Life>& lives) {
  std::vector<std::pair<SubgraphId, SubgraphId>> pairs;
  for (const Gap& gap : find_gaps(motion, lives)) pairs.emplace_back(gap.ending, gap.beginning);
  return pairs;
}

void continue_strokes(MotionGraph& motion, std::vector<Event>& events,
                      const std::map<SubgraphId, Life>& lives) {
  std::set<SubgraphId> goes_on;
  std::map<SubgraphId, SubgraphId> became;
  Additions additions(motion);
  for (const Gap& gap : find_gaps(motion, lives)) {
    if (goes_on.contains(gap.ending) || became.contains(gap.beginning)) continue;
    goes_on.insert(gap.ending);
    became[gap.beginning] = gap.ending;
    close(motion, gap, additions);
  }
  for (auto& [stroke, name] : became)
    for (auto at = became.find(name); at != became.end(); at = became.find(name)) name = at->second;
  motion = additions.motion(became);
  for (Event& event : events)
    for (auto* strokes : {&event.before, &event.after})
      for (SubgraphId& stroke : *strokes)
        if (const auto at = became.find(stroke); at != became.end()) stroke = at->second;
}

}  // namespace emberfold::graph::detail
