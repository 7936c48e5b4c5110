// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tuple>

#include <boost/pending/disjoint_sets.hpp>

#include "graph/events/events.hpp"
#include "graph/events/joints.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

/// A frame, its components, and what names them.
struct Side {
  const AttributeGraph* graph = nullptr;
  Components parts;
  std::vector<std::uint32_t> first;  ///< of each component its lowest vertex
  std::vector<bool> near_end;

  explicit Side(const AttributeGraph& g) : graph(&g), parts(components(g)), first(parts.count) {
    for (auto v = static_cast<std::uint32_t>(g.size()); v-- > 0;) first[parts.of_vertex[v]] = v;
    detail::Paths paths(g);
    near_end = detail::near_ends(g, paths);
  }
  [[nodiscard]] SubgraphId stroke(std::uint32_t part) const {
    return graph->vertices()[first[part]].subgraph;
  }
};

/// The pairs of components that hold the clusters together, p + q − 1 for a cluster of p before and q after:
/// those with the most links first. Ordered alike in both senses of time.
std::vector<detail::ComponentPair> spanning_pairs(std::vector<detail::ComponentPair> pairs,
                                                  std::size_t before, std::size_t after) {
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return std::tie(b.links, a.first.x, a.first.y, a.before, a.after) <
           std::tie(a.links, b.first.x, b.first.y, b.before, b.after);
  });
  std::vector<std::size_t> rank(before + after), parent(before + after);
  boost::disjoint_sets clusters(rank.data(), parent.data());
  for (std::size_t k = 0; k < before + after; ++k) clusters.make_set(k);
  std::vector<detail::ComponentPair> kept;
  for (const auto& pair : pairs) {
    const auto a = clusters.find_set(std::size_t{pair.before}), b = clusters.find_set(before + pair.after);
    if (a == b) continue;
    clusters.link(a, b);
    kept.push_back(pair);
  }
  return kept;
}

/// Of each component of one frame the vertices that are linked with components of the other frame.
using Ties = std::vector<std::vector<detail::Tie>>;

enum class Sense { forward, backward };

/// Unions (forward: `whole` is the frame after) or separations (backward: the frame before).
void join(const Side& whole, const Side& pieces, const Ties& ties, Sense sense, int frame,
          std::vector<Event>& events) {
  detail::Paths paths(*whole.graph);
  for (std::uint32_t part = 0; part < whole.parts.count; ++part) {
    const auto& of_part = ties[part];
    const auto as_first = [&](const detail::Tie& tie) { return tie.label == of_part.front().label; };
    if (std::all_of(of_part.begin(), of_part.end(), as_first)) continue;
    for (const detail::Joint& joint : detail::joints(*whole.graph, paths, of_part)) {
      Event event;
      event.frame = frame;
      event.position = joint.place;
      std::vector<SubgraphId> two{pieces.stroke(joint.label_a), pieces.stroke(joint.label_b)};
      std::sort(two.begin(), two.end());
      if (sense == Sense::forward) {
        event.type = joint.continues ? EventType::merge : EventType::connect;
        event.before = std::move(two);
        event.after = {whole.stroke(part)};
      } else {
        event.type = joint.continues ? EventType::split : EventType::disconnect;
        event.before = {whole.stroke(part)};
        event.after = std::move(two);
      }
      events.push_back(std::move(event));
    }
  }
}

/// Births (forward, `side` the frame after) or deaths (backward, the frame before).
void lone(const Side& side, const std::vector<bool>& tied, Sense sense, int frame,
          std::vector<Event>& events) {
  detail::Paths paths(*side.graph);
  for (std::uint32_t part = 0; part < side.parts.count; ++part) {
    if (tied[part]) continue;
    Event event;
    event.frame = frame;
    event.position = detail::component_middle(*side.graph, paths, side.first[part]);
    event.type = sense == Sense::forward ? EventType::birth : EventType::death;
    (sense == Sense::forward ? event.after : event.before) = {side.stroke(part)};
    events.push_back(std::move(event));
  }
}

void gap_events(const Side& before, const Side& after, std::span<const Link> links, int frame,
                std::vector<Event>& events) {
  const detail::Gap gap = detail::gap(*before.graph, *after.graph, links);
  const auto pairs = detail::component_pairs(*before.graph, *after.graph, before.parts, after.parts, gap);
  std::vector<bool> goes_on(before.parts.count, false), was_there(after.parts.count, false);
  for (const auto& pair : pairs) goes_on[pair.before] = was_there[pair.after] = true;
  lone(before, goes_on, Sense::backward, frame, events);
  lone(after, was_there, Sense::forward, frame, events);

  auto kept = spanning_pairs(pairs, before.parts.count, after.parts.count);
  std::sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) {
    return std::tie(a.before, a.after) < std::tie(b.before, b.after);
  });
  Ties of_before(before.parts.count), of_after(after.parts.count);
  for (const auto& [i, j] : gap.links) {
    const std::uint32_t a = before.parts.of_vertex[i], b = after.parts.of_vertex[j];
    const auto at = std::lower_bound(
        kept.begin(), kept.end(), std::tie(a, b),
        [](const auto& pair, const auto& key) { return std::tie(pair.before, pair.after) < key; });
    if (at == kept.end() || at->before != a || at->after != b) continue;
    of_before[a].push_back({i, b, after.near_end[j]});
    of_after[b].push_back({j, a, before.near_end[i]});
  }
  join(before, after, of_before, Sense::backward, frame, events);
  join(after, before, of_after, Sense::forward, frame, events);
}

/// How far a stroke moves from one frame to a neighbouring one, the mean over its links. Summed in the order
/// of the ways: the same bits in both senses of time.
Point shift(const MotionGraph& motion, int from, int to, SubgraphId stroke) {
  const AttributeGraph &a = motion.sketch.frames[static_cast<std::size_t>(from)],
                       &b = motion.sketch.frames[static_cast<std::size_t>(to)];
  std::vector<std::pair<double, double>> ways;
  for (const Link& link : motion.links[static_cast<std::size_t>(std::max(from, to))]) {
    const auto [before, after] = std::pair(link.before, link.after);
    const Vertex &p = a.vertices()[a.index_of(from < to ? before : after)],
                 &q = b.vertices()[b.index_of(from < to ? after : before)];
    if (p.subgraph != stroke || q.subgraph != stroke) continue;
    const Point way = q.patch.position - p.patch.position;
    ways.emplace_back(way.x, way.y);
  }
  std::sort(ways.begin(), ways.end());
  Point sum;
  for (const auto& [x, y] : ways) sum = sum + Point{x, y};
  return ways.empty() ? Point{} : sum * (1 / static_cast<double>(ways.size()));
}

/// A stroke that fades in shows in part at first, and may show too much: of its first frames (of a death, its
/// last) the one with the median number of patches tells its middle, less how far it moved, if that number is
/// another one than at first.
void settle(const MotionGraph& motion, Event& event) {
  constexpr int kFrames = 4;
  constexpr double kOther = 1.3;  // times as many patches, or fewer
  if (event.type != EventType::birth && event.type != EventType::death) return;
  const bool birth = event.type == EventType::birth;
  const SubgraphId stroke = birth ? event.after[0] : event.before[0];
  const auto& frames = motion.sketch.frames;
  const int first = birth ? event.frame : event.frame - 1, sense = birth ? 1 : -1;
  std::vector<std::pair<std::ptrdiff_t, int>> sizes;  // and frames
  for (int k = 0; k < kFrames; ++k) {
    const int t = first + sense * k;
    if (t < 0 || t >= static_cast<int>(frames.size())) break;
    const auto size = std::ranges::count_if(frames[static_cast<std::size_t>(t)].vertices(),
                                            [&](const Vertex& v) { return v.subgraph == stroke; });
    if (size == 0) break;
    sizes.emplace_back(size, sense * t);
  }
  const auto now = static_cast<double>(sizes.front().first);
  std::sort(sizes.begin(), sizes.end());
  const auto then = static_cast<double>(sizes[sizes.size() / 2].first);
  const int settled = sense * sizes[sizes.size() / 2].second;
  if (then <= kOther * now && now <= kOther * then) return;
  const AttributeGraph& graph = frames[static_cast<std::size_t>(settled)];
  const auto of_stroke =
      std::ranges::find_if(graph.vertices(), [&](const Vertex& v) { return v.subgraph == stroke; });
  detail::Paths paths(graph);
  event.position = detail::component_middle(graph, paths,
                                            static_cast<std::uint32_t>(of_stroke - graph.vertices().begin()));
  for (int t = settled; t != first; t -= sense)
    event.position = event.position + shift(motion, t, t - sense, stroke);
}

}  // namespace

std::vector<Event> stroke_events(const MotionGraph& motion) {
  validate(motion);
  const auto& frames = motion.sketch.frames;
  std::vector<Event> events;
  if (frames.empty()) return events;
  Side before(frames[0]);
  for (std::size_t t = 1; t < frames.size(); ++t) {
    Side after(frames[t]);
    gap_events(before, after, motion.links[t], static_cast<int>(t), events);
    before = std::move(after);
  }
  for (Event& event : events) settle(motion, event);
  sort_events(events);
  return events;
}

}  // namespace emberfold::graph
