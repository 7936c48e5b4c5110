// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include <boost/pending/disjoint_sets.hpp>

#include "graph/events/events.hpp"
#include "graph/events/joints.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

// A stroke that fades in shows in part at first, and may then show too much.
constexpr int kSettlingFrames = 4;       // frames after a birth, or before a death, whose median size counts
constexpr double kUnsettledRatio = 1.3;  // of sizes in patches: up to it the first frame gives the position

/// A frame with its components and their strokes.
struct FrameParts {
  const AttributeGraph* graph = nullptr;
  Components parts;
  std::vector<std::uint32_t> first;  ///< lowest vertex of each component
  std::vector<bool> near_end;        ///< whether a vertex lies near an end of a curve

  explicit FrameParts(const AttributeGraph& g) : graph(&g), parts(components(g)), first(parts.count) {
    for (auto v = static_cast<std::uint32_t>(g.size()); v-- > 0;) first[parts.of_vertex[v]] = v;
    detail::ShortestPaths paths(g);
    near_end = detail::find_vertices_near_ends(g, paths);
  }
  [[nodiscard]] SubgraphId stroke(std::uint32_t part) const {
    return graph->vertices()[first[part]].subgraph;
  }
};

/// Selects a spanning forest of the linked components, pairs with the most links first.
/// A cluster of p components before and q after keeps p + q − 1 pairs. Reversing time selects the same pairs.
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

/// For each component of one frame, the vertices that are linked with components of the other frame.
using LinkedVertices = std::vector<std::vector<detail::PartVertex>>;

enum class Sense { forward, backward };

std::vector<VertexId> ids_of(const AttributeGraph& graph, std::span<const std::uint32_t> path) {
  std::vector<VertexId> result;
  for (const std::uint32_t v : path) result.push_back(graph.vertices()[v].id);
  return result;
}

/// Adds unions (forward: `whole` is the frame after) or separations (backward: it is the frame before).
void add_joint_events(const FrameParts& whole, const FrameParts& pieces, const LinkedVertices& linked,
                      Sense sense, int frame, std::vector<TracedEvent>& events) {
  const int whole_frame = sense == Sense::forward ? frame : frame - 1;
  detail::ShortestPaths paths(*whole.graph);
  for (std::uint32_t part = 0; part < whole.parts.count; ++part) {
    const auto& of_part = linked[part];
    const auto of_first = [&](const detail::PartVertex& member) {
      return member.label == of_part.front().label;
    };
    if (std::all_of(of_part.begin(), of_part.end(), of_first)) continue;
    for (const detail::Joint& joint : detail::find_joints(*whole.graph, paths, of_part)) {
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
      events.push_back({std::move(event), whole_frame, ids_of(*whole.graph, joint.path)});
    }
  }
}

/// Adds births (forward: `side` is the frame after) or deaths (backward: it is the frame before).
void add_births_or_deaths(const FrameParts& side, const std::vector<bool>& linked, Sense sense, int frame,
                          std::vector<TracedEvent>& events) {
  const int side_frame = sense == Sense::forward ? frame : frame - 1;
  detail::ShortestPaths paths(*side.graph);
  for (std::uint32_t part = 0; part < side.parts.count; ++part) {
    if (linked[part]) continue;
    Event event;
    event.frame = frame;
    const auto path = detail::longest_path(paths, side.first[part]);
    event.position = detail::path_middle(*side.graph, path);
    event.type = sense == Sense::forward ? EventType::birth : EventType::death;
    (sense == Sense::forward ? event.after : event.before) = {side.stroke(part)};
    events.push_back({std::move(event), side_frame, ids_of(*side.graph, path)});
  }
}

/// Leaves out the vertices whose partner in the other frame is there no longer than that, where others of
/// their part stay: what fades between two strokes belongs to neither. `partners`: of the vertices of
/// `linked`.
void leave_out_fading(LinkedVertices& linked, const std::vector<std::vector<std::uint32_t>>& partners,
                      const std::vector<bool>& stays) {
  for (std::size_t part = 0; part < linked.size(); ++part) {
    const auto& all = linked[part];
    std::vector<detail::PartVertex> lasting;
    std::vector<std::uint32_t> labels;  // that have lasting vertices
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!stays[partners[part][k]]) continue;
      lasting.push_back(all[k]);
      labels.push_back(all[k].label);
    }
    std::ranges::sort(labels);
    std::ranges::copy_if(all, std::back_inserter(lasting), [&](const detail::PartVertex& vertex) {
      return !std::ranges::binary_search(labels, vertex.label);
    });
    linked[part] = std::move(lasting);
  }
}

/// Returns which patches of a frame are there in the next one, too (`ahead`), or were in the one before.
/// Beyond the clip's ends all are, and so is one alone among patches that are: where a curve is cut into
/// patches anew their number varies by one.
std::vector<bool> staying_patches(const MotionGraph& motion, std::size_t frame, bool ahead) {
  const AttributeGraph& graph = motion.sketch.frames[frame];
  if (ahead ? frame + 1 == motion.sketch.frames.size() : frame == 0)
    return std::vector<bool>(graph.size(), true);
  std::vector<bool> is_linked(graph.size(), false);
  for (const Link& link : motion.links[ahead ? frame + 1 : frame])
    is_linked[graph.index_of(ahead ? link.before : link.after)] = true;
  std::vector<bool> stays(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    const auto near = graph.neighbours(v);
    stays[v] = is_linked[v] ||
               (!near.empty() && std::ranges::all_of(near, [&](std::uint32_t w) { return is_linked[w]; }));
  }
  return stays;
}

void add_frame_events(const FrameParts& before, const FrameParts& after, const MotionGraph& motion, int frame,
                      std::vector<TracedEvent>& events) {
  const auto t = static_cast<std::size_t>(frame);
  const detail::FrameLinks found = detail::index_links(*before.graph, *after.graph, motion.links[t]);
  const auto pairs = detail::component_pairs(*before.graph, *after.graph, before.parts, after.parts, found);
  std::vector<bool> goes_on(before.parts.count, false), was_there(after.parts.count, false);
  for (const auto& pair : pairs) goes_on[pair.before] = was_there[pair.after] = true;
  add_births_or_deaths(before, goes_on, Sense::backward, frame, events);
  add_births_or_deaths(after, was_there, Sense::forward, frame, events);

  auto kept = spanning_pairs(pairs, before.parts.count, after.parts.count);
  std::sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) {
    return std::tie(a.before, a.after) < std::tie(b.before, b.after);
  });
  const auto was_there_before = staying_patches(motion, t - 1, false),
             goes_on_after = staying_patches(motion, t, true);
  LinkedVertices of_before(before.parts.count), of_after(after.parts.count);
  std::vector<std::vector<std::uint32_t>> partners_of_before(before.parts.count),
      partners_of_after(after.parts.count);
  for (const auto& [i, j] : found.links) {
    const std::uint32_t a = before.parts.of_vertex[i], b = after.parts.of_vertex[j];
    const auto at = std::lower_bound(
        kept.begin(), kept.end(), std::tie(a, b),
        [](const auto& pair, const auto& key) { return std::tie(pair.before, pair.after) < key; });
    if (at == kept.end() || at->before != a || at->after != b) continue;
    of_before[a].push_back({i, b, after.near_end[j]});
    of_after[b].push_back({j, a, before.near_end[i]});
    partners_of_before[a].push_back(j);
    partners_of_after[b].push_back(i);
  }
  leave_out_fading(of_before, partners_of_before, goes_on_after);
  leave_out_fading(of_after, partners_of_after, was_there_before);
  add_joint_events(before, after, of_before, Sense::backward, frame, events);
  add_joint_events(after, before, of_after, Sense::forward, frame, events);
}

/// Corrects the position of a birth or death of a stroke that fades.
/// Its middle is taken in the frame of the median number of patches, of the first frames after a birth (the
/// last before a death), and moved back by the mean displacements. Nothing changes if that number is as at
/// first.
void correct_place(const MotionGraph& motion, Event& event) {
  if (event.type != EventType::birth && event.type != EventType::death) return;
  const bool birth = event.type == EventType::birth;
  const SubgraphId stroke = birth ? event.after[0] : event.before[0];
  const auto& frames = motion.sketch.frames;
  const int first = birth ? event.frame : event.frame - 1, sense = birth ? 1 : -1;
  std::vector<std::pair<std::ptrdiff_t, int>> sizes;  // patches, frame
  for (int k = 0; k < kSettlingFrames; ++k) {
    const int t = first + sense * k;
    if (t < 0 || t >= static_cast<int>(frames.size())) break;
    const auto size = std::ranges::count_if(frames[static_cast<std::size_t>(t)].vertices(),
                                            [&](const Vertex& v) { return v.subgraph == stroke; });
    if (size == 0) break;
    sizes.emplace_back(size, sense * t);
  }
  const auto now = static_cast<double>(sizes.front().first);
  std::sort(sizes.begin(), sizes.end());
  const auto& middle = sizes[sizes.size() / 2];
  const auto then = static_cast<double>(middle.first);
  const int settled = sense * middle.second;
  if (then <= kUnsettledRatio * now && now <= kUnsettledRatio * then) return;
  const AttributeGraph& graph = frames[static_cast<std::size_t>(settled)];
  const auto of_stroke =
      std::ranges::find_if(graph.vertices(), [&](const Vertex& v) { return v.subgraph == stroke; });
  detail::ShortestPaths paths(graph);
  event.position = detail::component_middle(graph, paths,
                                            static_cast<std::uint32_t>(of_stroke - graph.vertices().begin()));
  for (int t = settled; t != first; t -= sense)
    event.position = event.position + detail::mean_displacement(motion, stroke, static_cast<std::size_t>(t),
                                                                static_cast<std::size_t>(t - sense));
}

}  // namespace

std::vector<TracedEvent> trace_stroke_events(const MotionGraph& motion) {
  validate(motion);
  const auto& frames = motion.sketch.frames;
  std::vector<TracedEvent> events;
  if (frames.empty()) return events;
  FrameParts before(frames[0]);
  for (std::size_t t = 1; t < frames.size(); ++t) {
    FrameParts after(frames[t]);
    add_frame_events(before, after, motion, static_cast<int>(t), events);
    before = std::move(after);
  }
  for (TracedEvent& traced : events) correct_place(motion, traced.event);
  std::ranges::stable_sort(events, [](const auto& a, const auto& b) { return precedes(a.event, b.event); });
  return events;
}

std::vector<Event> stroke_events(const MotionGraph& motion) {
  std::vector<Event> events;
  for (TracedEvent& traced : trace_stroke_events(motion)) events.push_back(std::move(traced.event));
  return events;
}

}  // namespace emberfold::graph
