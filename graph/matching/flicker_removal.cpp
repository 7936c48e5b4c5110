// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/flicker_removal.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "graph/events/event_family.hpp"
#include "graph/matching/frame_draft.hpp"
#include "graph/matching/lasting.hpp"

namespace emberfold::graph {

namespace {

using detail::Draft;
using detail::Lasting;

// Larger distances repair more flicker, and sooner take two strokes for one.
constexpr double kSamePlace = 15;   // px: largest distance between the two events of one joint
constexpr double kSameStroke = 4;   // px: largest mean distance of a stroke that comes back
constexpr double kNearMiddle = 20;  // px: the same of its middle, which growth moves too
constexpr double kWidestTear = 25;  // px: widest gap that is bridged
constexpr double kWidestGap = 60;   // px: the same where pieces part and unite in one place
constexpr int kSpeck = 1;           // frames: what lasts no longer cannot be followed

std::vector<Draft> make_drafts(const SketchSequence& sketch) {
  return {sketch.frames.begin(), sketch.frames.end()};
}

// ---- strokes that last too short a time ----

/// Removes the vertices that do not last. Inserted ones and repaired strokes stay.
void remove_short_lived(Draft& draft, std::size_t frame, const Lasting& lasts,
                        const std::set<SubgraphId>& repaired) {
  const auto vertices = draft.base().vertices();
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (!lasts(frame, i) && !repaired.contains(vertices[i].subgraph)) draft.remove(vertices[i].id);
}

// ---- strokes that are missing, joined or broken for a short time ----

/// Returns the mean distance from the patches of stroke a to the nearest of b that can be linked, px.
double mean_distance(const AttributeGraph& a, std::span<const std::uint32_t> of_a, const AttributeGraph& b,
                     std::span<const std::uint32_t> of_b) {
  double sum = 0;
  for (const std::uint32_t i : of_a) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t j : of_b) {
      if (same_kind(a.patch(i), b.patch(j)))
        least = std::min(least, distance(a.patch(i).position, b.patch(j).position));
    }
    sum += least;
  }
  return sum / static_cast<double>(of_a.size());
}

/// Copies a stroke of frame `from` into the frames [first, last), with new ids.
void insert_stroke(std::vector<Draft>& drafts, const AttributeGraph& from,
                   std::span<const std::uint32_t> stroke, int first, int last, std::uint32_t& next_id) {
  for (int t = first; t < last; ++t) {
    Draft& draft = drafts[static_cast<std::size_t>(t)];
    std::map<VertexId, VertexId> copies;
    for (const std::uint32_t i : stroke) {
      Vertex copy = from.vertices()[i];
      copies.emplace(copy.id, VertexId{next_id});
      copy.id = {next_id++};
      draft.add(copy);
    }
    for (const Edge& e : from.edges()) {
      const auto a = copies.find(e.a), b = copies.find(e.b);
      if (a != copies.end() && b != copies.end()) draft.join({a->second, b->second});
    }
  }
}

/// Returns whether no other path connects the ends of the edge.
bool is_cut_edge(const std::multimap<VertexId, VertexId>& neighbours, Edge edge) {
  std::set<VertexId> reached = {edge.a};
  std::vector<VertexId> open = {edge.a};
  while (!open.empty()) {
    const VertexId at = open.back();
    open.pop_back();
    const auto [first, last] = neighbours.equal_range(at);
    for (auto n = first; n != last; ++n) {
      if ((at == edge.a && n->second == edge.b) || !reached.insert(n->second).second) continue;
      open.push_back(n->second);
    }
    if (reached.contains(edge.b)) return false;
  }
  return true;
}

/// Removes the cut edge of the stroke that is nearest to the place, within kSamePlace.
void cut_stroke(Draft& draft, SubgraphId stroke, Point place) {
  std::map<VertexId, Point> positions;
  draft.each_vertex([&](const Vertex& v) {
    if (v.subgraph == stroke) positions.emplace(v.id, v.patch.position);
  });
  std::multimap<VertexId, VertexId> neighbours;
  std::vector<std::pair<double, Edge>> near;
  draft.each_edge([&](const Edge& e) {
    const auto a = positions.find(e.a), b = positions.find(e.b);
    if (a == positions.end() || b == positions.end()) return;
    neighbours.emplace(e.a, e.b);
    neighbours.emplace(e.b, e.a);
    const double way = distance((a->second + b->second) * 0.5, place);
    if (way < kSamePlace) near.emplace_back(way, e);
  });
  std::sort(near.begin(), near.end());
  const auto first = std::find_if(near.begin(), near.end(),
                                  [&](const auto& n) { return is_cut_edge(neighbours, n.second); });
  if (first != near.end()) draft.cut(first->second);
}

/// Joins two of these strokes by an edge between their nearest patches, less than `widest` px apart.
/// With more than two strokes, only patches near the place are joined. Returns whether any were.
bool bridge_pieces(Draft& draft, std::span<const SubgraphId> strokes, Point place, double widest) {
  std::vector<const Vertex*> members;
  draft.each_vertex([&](const Vertex& v) {
    if (std::ranges::find(strokes, v.subgraph) != strokes.end()) members.push_back(&v);
  });
  const bool several = std::ranges::any_of(
      members, [&](const Vertex* v) { return v->subgraph != strokes[0] && v->subgraph != strokes[1]; });
  double least = widest;
  std::optional<Edge> nearest;
  for (const Vertex* a : members) {
    for (const Vertex* b : members) {
      if (!(a->subgraph < b->subgraph)) continue;
      const Point middle = (a->patch.position + b->patch.position) * 0.5;
      if (several && distance(middle, place) > kSamePlace) continue;
      const double way = distance(a->patch.position, b->patch.position);
      if (way >= least) continue;
      least = way;
      nearest = Edge{std::min(a->id, b->id), std::max(a->id, b->id)};
    }
  }
  if (nearest) draft.join(*nearest);
  return nearest.has_value();
}

/// Removes all vertices of a stroke.
void remove_stroke(Draft& draft, SubgraphId stroke) {
  std::vector<VertexId> gone;
  draft.each_vertex([&](const Vertex& v) {
    if (v.subgraph == stroke) gone.push_back(v.id);
  });
  for (const VertexId id : gone) draft.remove(id);
}

/// Finds pairs of events that reverse each other within `frames` frames, and reverts both in the drafts.
/// Every event belongs to one pair at most.
class FlickerRepair {
 public:
  FlickerRepair(const MotionGraph& motion, const Lasting& lasts, int frames)
      : motion_(motion), lasts_(lasts), events_(stroke_events(motion)), frames_(frames) {}

  /// Repairs the drafts; returns the strokes that were copied into frames which lacked them.
  std::set<SubgraphId> repair(std::vector<Draft>& drafts) {
    std::uint32_t next_id = 0;
    for (const AttributeGraph& g : motion_.sketch.frames)
      if (!g.empty()) next_id = g.vertices().back().id.value + 1;
    std::set<SubgraphId> repaired;
    std::vector<bool> done(events_.size(), false);
    merge_short_pieces(drafts, done);
    // Shortest first: of three alternating changes the nearest two form the pair.
    for (int apart = 1; apart <= frames_; ++apart) {
      for (std::size_t i = 0; i < events_.size(); ++i) {
        for (std::size_t j = i + 1; j < events_.size() && events_[j].frame <= events_[i].frame + apart; ++j) {
          if (done[i] || done[j] || events_[j].frame != events_[i].frame + apart ||
              !repair_pair(drafts, events_[i], events_[j], next_id))
            continue;
          done[i] = done[j] = true;
          if (events_[i].type == EventType::death)
            repaired.insert({events_[i].before[0], events_[j].after[0]});
        }
      }
    }
    return repaired;
  }

 private:
  /// Merges short-lived pieces with their stroke: those that separate and soon die, or are born and soon
  /// unite. They are an end of the stroke that fades out or in. If both pieces are short-lived, the stroke
  /// fades as a whole and its pieces are joined, or, where too much of it is missing between them, the larger
  /// stands for it.
  void merge_short_pieces(std::vector<Draft>& drafts, std::vector<bool>& done) const {
    for (std::size_t i = 0; i < events_.size(); ++i) {
      if (!detail::is_separation(events_[i].type) && !detail::is_union(events_[i].type)) continue;
      const Event& joint = events_[i];
      const bool parts = detail::is_separation(joint.type);
      const auto& pieces = parts ? joint.after : joint.before;
      if (pieces.size() != 2 || done[i]) continue;
      const std::array ends = {find_piece_end(pieces[0], joint.frame, parts),
                               find_piece_end(pieces[1], joint.frame, parts)};
      const auto& there =
          motion_.sketch.frames[static_cast<std::size_t>(parts ? joint.frame : joint.frame - 1)];
      const std::array sizes = {vertices_of(there, pieces[0]).size(), vertices_of(there, pieces[1]).size()};
      const auto frames_of = [&](int end) {
        return std::pair(std::min(joint.frame, end), std::max(joint.frame, end));
      };
      if (ends[0] && ends[1]) {
        const int end = parts ? std::min(*ends[0], *ends[1]) : std::max(*ends[0], *ends[1]);
        const auto [first, last] = frames_of(end);
        const SubgraphId smaller = pieces[sizes[0] < sizes[1] ? 0 : 1];
        for (int t = first; t < last; ++t) {
          Draft& draft = drafts[static_cast<std::size_t>(t)];
          if (!bridge_pieces(draft, pieces, joint.position, kWidestTear)) remove_stroke(draft, smaller);
        }
        done[i] = true;
        continue;
      }
      for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        if (!ends[k] || sizes[k] > sizes[1 - k]) continue;
        const auto [first, last] = frames_of(*ends[k]);
        for (int t = first; t < last; ++t) remove_stroke(drafts[static_cast<std::size_t>(t)], pieces[k]);
        done[i] = true;
      }
    }
  }

  /// Returns the frame of the piece's death (its birth if it unites), if that is within `frames` frames.
  [[nodiscard]] std::optional<int> find_piece_end(SubgraphId piece, int frame, bool parts) const {
    const auto before = [](const Event& e, int t) { return e.frame < t; };
    const auto begin = std::lower_bound(events_.begin(), events_.end(), frame - frames_, before);
    const auto end = std::lower_bound(begin, events_.end(), frame + frames_ + 1, before);
    for (const Event& e : std::span(begin, end)) {
      if (parts && e.type == EventType::death && e.before[0] == piece && e.frame - frame <= frames_)
        return e.frame;
      if (!parts && e.type == EventType::birth && e.after[0] == piece && frame - e.frame <= frames_)
        return e.frame;
    }
    return std::nullopt;
  }

  /// Reverts two events if they form a pair; returns whether they did.
  bool repair_pair(std::vector<Draft>& drafts, const Event& first, const Event& second,
                   std::uint32_t& next_id) const {
    const auto each = [&](auto change) {
      for (int t = first.frame; t < second.frame; ++t) change(drafts[static_cast<std::size_t>(t)]);
    };
    const auto shared = [&] {
      return std::ranges::any_of(first.after, [&](SubgraphId s) {
        return std::ranges::find(second.before, s) != second.before.end();
      });
    };
    const bool same_place = distance(first.position, second.position) < kSamePlace;
    if (detail::is_separation(first.type) && detail::is_union(second.type) &&
        (first.after == second.before || (shared() && same_place))) {
      std::vector<SubgraphId> pieces = first.after;
      pieces.insert(pieces.end(), second.before.begin(), second.before.end());
      each([&](Draft& draft) {
        bridge_pieces(draft, pieces, first.position, same_place ? kWidestGap : kWidestTear);
      });
      return true;
    }
    if (detail::is_union(first.type) && detail::is_separation(second.type) && first.after == second.before &&
        same_place) {
      each([&](Draft& draft) { cut_stroke(draft, first.after[0], first.position); });
      return true;
    }
    if (first.type == EventType::death && second.type == EventType::birth &&
        distance(first.position, second.position) < kNearMiddle) {
      const auto last = static_cast<std::size_t>(first.frame) - 1,
                 again = static_cast<std::size_t>(second.frame);
      const AttributeGraph &before = motion_.sketch.frames[last], &after = motion_.sketch.frames[again];
      const auto gone = vertices_of(before, first.before[0]), back = vertices_of(after, second.after[0]);
      if (!lasts_(last, gone.front()) || !lasts_(again, back.front())) return false;
      if (mean_distance(before, gone, after, back) > kSameStroke ||
          mean_distance(after, back, before, gone) > kSameStroke)
        return false;
      insert_stroke(drafts, before, gone, first.frame, second.frame, next_id);
      return true;
    }
    return false;
  }

  const MotionGraph& motion_;
  const Lasting& lasts_;
  std::vector<Event> events_;
  int frames_;
};

}  // namespace

SketchSequence remove_flicker(const MotionGraph& motion, int frames) {
  if (motion.sketch.frames.empty() || frames <= 0) return motion.sketch;
  std::vector<Draft> changed = make_drafts(motion.sketch);
  const auto repaired = FlickerRepair(motion, Lasting(motion, frames), frames).repair(changed);
  const Lasting lasts(motion, kSpeck);
  SketchSequence result{motion.sketch.width, motion.sketch.height, motion.sketch.fps, {}};
  for (std::size_t t = 0; t < changed.size(); ++t) {
    remove_short_lived(changed[t], t, lasts, repaired);
    result.append(changed[t].graph());
    changed[t] = Draft(AttributeGraph());
  }
  return result;
}

}  // namespace emberfold::graph
