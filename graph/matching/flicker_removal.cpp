// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/flicker_removal.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include <boost/pending/disjoint_sets.hpp>

#include "core/math/robust.hpp"
#include "graph/events/events.hpp"

namespace emberfold::graph {

namespace {

// Larger distances repair more flicker, and sooner take two strokes for one.
constexpr double kSamePlace = 15;       // px: largest distance between the two events of one joint
constexpr double kSameStroke = 4;       // px: largest mean distance of a stroke that comes back
constexpr double kNearMiddle = 20;      // px: the same of its middle, which growth moves too
constexpr double kWidestTear = 25;      // px: widest gap that is bridged
constexpr double kWidestGap = 60;       // px: the same where pieces part and unite in one place
constexpr double kMostPersistence = 2;  // largest factor on how long a stroke of low gain has to last

/// A frame that is being changed.
struct Draft {
  std::vector<Vertex> vertices;
  std::set<Edge> edges;

  [[nodiscard]] AttributeGraph graph() const { return {vertices, {edges.begin(), edges.end()}}; }
};

std::vector<Draft> make_drafts(const SketchSequence& sketch) {
  std::vector<Draft> result;
  for (const AttributeGraph& g : sketch.frames) {
    result.push_back({{g.vertices().begin(), g.vertices().end()}, {g.edges().begin(), g.edges().end()}});
  }
  return result;
}

void remove_vertices(Draft& draft, const std::set<VertexId>& gone) {
  std::erase_if(draft.edges, [&](const Edge& e) { return gone.contains(e.a) || gone.contains(e.b); });
  std::erase_if(draft.vertices, [&](const Vertex& v) { return gone.contains(v.id); });
}

// ---- strokes that last too short a time ----

/// Returns the factor on the least duration of a stroke: 1 for patches of median gain, up to 2 for lower
/// gains.
double persistence_factor(double gain, double usual) {
  if (!(usual > 0)) return 1;
  return gain * kMostPersistence <= usual ? kMostPersistence : std::max(1.0, usual / gain);
}

/// Finds for each vertex whether its component over all frames, by edges and links, lasts long enough.
/// `weigh_gain`: components of low gain have to last longer.
std::map<VertexId, bool> find_lasting(const MotionGraph& motion, int frames, bool weigh_gain) {
  std::map<VertexId, std::size_t> index;
  std::vector<std::size_t> frame_of;
  std::vector<double> gains;
  for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
    for (const Vertex& v : motion.sketch.frames[t].vertices()) {
      index.emplace(v.id, index.size());
      frame_of.push_back(t);
      gains.push_back(v.patch.gain);
    }
  }
  const std::size_t n = index.size();
  std::vector<std::size_t> rank(n), parent(n);
  boost::disjoint_sets wholes(rank.data(), parent.data());
  for (std::size_t i = 0; i < n; ++i) wholes.make_set(i);
  for (const AttributeGraph& g : motion.sketch.frames) {
    for (const Edge& e : g.edges()) wholes.union_set(index.at(e.a), index.at(e.b));
  }
  for (const auto& gap : motion.links) {
    for (const Link& l : gap) wholes.union_set(index.at(l.before), index.at(l.after));
  }
  std::vector<std::size_t> first(n, std::numeric_limits<std::size_t>::max()), last(n, 0);
  std::vector<double> gain(n, 0), patches(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t root = wholes.find_set(i);
    first[root] = std::min(first[root], frame_of[i]);
    last[root] = std::max(last[root], frame_of[i]);
    gain[root] += gains[i];
    patches[root] += 1;
  }
  const double usual = gains.empty() ? 0 : core::median(gains);
  const std::size_t end = motion.sketch.frames.size() - 1;
  std::map<VertexId, bool> result;
  for (const auto& [id, i] : index) {
    const std::size_t root = wholes.find_set(i);
    // It may have lasted longer outside the clip.
    const double least =
        first[root] == 0 || last[root] == end
            ? 1
            : frames * (weigh_gain ? persistence_factor(gain[root] / patches[root], usual) : 1);
    result.emplace(id, static_cast<double>(last[root] - first[root] + 1) > least);
  }
  return result;
}

/// Removes the vertices that do not last. Inserted ones, which `lasts` lacks, and repaired strokes stay.
void remove_short_lived(std::vector<Draft>& drafts, const std::map<VertexId, bool>& lasts,
                        const std::set<SubgraphId>& repaired) {
  for (Draft& draft : drafts) {
    std::set<VertexId> gone;
    for (const Vertex& v : draft.vertices) {
      const auto known = lasts.find(v.id);
      if (known != lasts.end() && !known->second && !repaired.contains(v.subgraph)) gone.insert(v.id);
    }
    remove_vertices(draft, gone);
  }
}

// ---- strokes that are missing, joined or broken for a short time ----

/// Lists the vertices of a stroke.

std::vector<std::uint32_t> find_vertices(const AttributeGraph& graph, SubgraphId stroke) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    if (graph.vertices()[i].subgraph == stroke) result.push_back(i);
  }
  return result;
}

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
      draft.vertices.push_back(copy);
    }
    for (const Edge& e : from.edges()) {
      const auto a = copies.find(e.a), b = copies.find(e.b);
      if (a != copies.end() && b != copies.end()) draft.edges.insert({a->second, b->second});
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
  for (const Vertex& v : draft.vertices) {
    if (v.subgraph == stroke) positions.emplace(v.id, v.patch.position);
  }
  std::multimap<VertexId, VertexId> neighbours;
  std::vector<std::pair<double, Edge>> near;
  for (const Edge& e : draft.edges) {
    const auto a = positions.find(e.a), b = positions.find(e.b);
    if (a == positions.end() || b == positions.end()) continue;
    neighbours.emplace(e.a, e.b);
    neighbours.emplace(e.b, e.a);
    const double way = distance((a->second + b->second) * 0.5, place);
    if (way < kSamePlace) near.emplace_back(way, e);
  }
  std::sort(near.begin(), near.end());
  const auto first = std::find_if(near.begin(), near.end(),
                                  [&](const auto& n) { return is_cut_edge(neighbours, n.second); });
  if (first != near.end()) draft.edges.erase(first->second);
}

/// Joins two of these strokes by an edge between their nearest patches, less than `widest` px apart.
/// With more than two strokes, only patches near the place are joined.
void bridge_pieces(Draft& draft, std::span<const SubgraphId> strokes, Point place, double widest) {
  std::vector<const Vertex*> members;
  for (const Vertex& v : draft.vertices) {
    if (std::ranges::find(strokes, v.subgraph) != strokes.end()) members.push_back(&v);
  }
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
  if (nearest) draft.edges.insert(*nearest);
}

/// Removes all vertices of a stroke.
void remove_stroke(Draft& draft, SubgraphId stroke) {
  std::set<VertexId> gone;
  for (const Vertex& v : draft.vertices) {
    if (v.subgraph == stroke) gone.insert(v.id);
  }
  remove_vertices(draft, gone);
}

bool is_union(const Event& e) {
  return e.type == EventType::merge || e.type == EventType::connect;
}
bool is_separation(const Event& e) {
  return e.type == EventType::split || e.type == EventType::disconnect;
}

/// Finds pairs of events that reverse each other within `frames` frames, and reverts both in the drafts.
/// Every event belongs to one pair at most.
class FlickerRepair {
 public:
  FlickerRepair(const MotionGraph& motion, const std::map<VertexId, bool>& lasts, int frames)
      : motion_(motion), lasts_(lasts), events_(stroke_events(motion)), frames_(frames) {}

  /// Repairs the drafts; returns the strokes that were copied into frames which lacked them.
  std::set<SubgraphId> repair(std::vector<Draft>& drafts) {
    std::uint32_t next_id = 0;
    for (const Draft& d : drafts) {
      for (const Vertex& v : d.vertices) next_id = std::max(next_id, v.id.value + 1);
    }
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
  /// fades as a whole and its pieces are joined.
  void merge_short_pieces(std::vector<Draft>& drafts, std::vector<bool>& done) const {
    for (std::size_t i = 0; i < events_.size(); ++i) {
      if (!is_separation(events_[i]) && !is_union(events_[i])) continue;
      const Event& joint = events_[i];
      const bool parts = is_separation(joint);
      const auto& pieces = parts ? joint.after : joint.before;
      if (pieces.size() != 2 || done[i]) continue;
      const std::array ends = {find_piece_end(pieces[0], joint.frame, parts),
                               find_piece_end(pieces[1], joint.frame, parts)};
      const auto& there =
          motion_.sketch.frames[static_cast<std::size_t>(parts ? joint.frame : joint.frame - 1)];
      const std::array sizes = {find_vertices(there, pieces[0]).size(),
                                find_vertices(there, pieces[1]).size()};
      const auto frames_of = [&](int end) {
        return std::pair(std::min(joint.frame, end), std::max(joint.frame, end));
      };
      if (ends[0] && ends[1]) {
        const int end = parts ? std::min(*ends[0], *ends[1]) : std::max(*ends[0], *ends[1]);
        const auto [first, last] = frames_of(end);
        for (int t = first; t < last; ++t)
          bridge_pieces(drafts[static_cast<std::size_t>(t)], pieces, joint.position, kWidestTear);
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
    for (const Event& e : events_) {
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
    if (is_separation(first) && is_union(second) &&
        (first.after == second.before || (shared() && same_place))) {
      std::vector<SubgraphId> pieces = first.after;
      pieces.insert(pieces.end(), second.before.begin(), second.before.end());
      each([&](Draft& draft) {
        bridge_pieces(draft, pieces, first.position, same_place ? kWidestGap : kWidestTear);
      });
      return true;
    }
    if (is_union(first) && is_separation(second) && first.after == second.before && same_place) {
      each([&](Draft& draft) { cut_stroke(draft, first.after[0], first.position); });
      return true;
    }
    if (first.type == EventType::death && second.type == EventType::birth &&
        distance(first.position, second.position) < kNearMiddle) {
      const AttributeGraph& before = motion_.sketch.frames[static_cast<std::size_t>(first.frame - 1)];
      const AttributeGraph& after = motion_.sketch.frames[static_cast<std::size_t>(second.frame)];
      const auto gone = find_vertices(before, first.before[0]), back = find_vertices(after, second.after[0]);
      if (!lasts_.at(before.vertices()[gone.front()].id) || !lasts_.at(after.vertices()[back.front()].id))
        return false;
      if (mean_distance(before, gone, after, back) > kSameStroke ||
          mean_distance(after, back, before, gone) > kSameStroke)
        return false;
      insert_stroke(drafts, before, gone, first.frame, second.frame, next_id);
      return true;
    }
    return false;
  }

  const MotionGraph& motion_;
  const std::map<VertexId, bool>& lasts_;
  std::vector<Event> events_;
  int frames_;
};

}  // namespace

SketchSequence remove_flicker(const MotionGraph& motion, int frames) {
  if (motion.sketch.frames.empty() || frames <= 0) return motion.sketch;
  const std::map<VertexId, bool> lasts = find_lasting(motion, frames, false);
  std::vector<Draft> changed = make_drafts(motion.sketch);
  const std::set<SubgraphId> repaired = FlickerRepair(motion, lasts, frames).repair(changed);
  remove_short_lived(changed, find_lasting(motion, frames, true), repaired);
  SketchSequence result{motion.sketch.width, motion.sketch.height, motion.sketch.fps, {}};
  for (const Draft& draft : changed) result.append(draft.graph());
  return result;
}

}  // namespace emberfold::graph
