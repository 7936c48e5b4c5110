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

#include "graph/events/events.hpp"

namespace emberfold::graph {

namespace {

constexpr double kSamePlace =
    15;  // px: a joint that opens again this near to where it closed is the same joint
constexpr double kSameStroke =
    4;  // px, mean: a stroke that comes back this near to where it was is the same stroke
constexpr double kNearMiddle = 20;  // px: its middle may move more than its patches do, by what it grew
constexpr double kWidestTear = 25;  // px: pieces farther apart are not joined
constexpr double kWidestGap = 60;   // px: but where they part and unite in one place, a stretch was missed

/// A frame while it is being changed.
struct Draft {
  std::vector<Vertex> vertices;
  std::set<Edge> edges;

  [[nodiscard]] AttributeGraph graph() const { return {vertices, {edges.begin(), edges.end()}}; }
};

std::vector<Draft> drafts(const SketchSequence& sketch) {
  std::vector<Draft> result;
  for (const AttributeGraph& g : sketch.frames) {
    result.push_back({{g.vertices().begin(), g.vertices().end()}, {g.edges().begin(), g.edges().end()}});
  }
  return result;
}

void take_out(Draft& draft, const std::set<VertexId>& gone) {
  std::erase_if(draft.edges, [&](const Edge& e) { return gone.contains(e.a) || gone.contains(e.b); });
  std::erase_if(draft.vertices, [&](const Vertex& v) { return gone.contains(v.id); });
}

// ---- what is there for a moment ----

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// How many times as long a stroke has to be seen whose patches gain less than usual: until they have gained
/// as much, twice as long at most.
double doubted(double gain, double usual) {
  constexpr double kMost = 2;
  if (!(usual > 0)) return 1;
  return gain * kMost <= usual ? kMost : std::max(1.0, usual / gain);
}

/// Vertices that edges and links hold together, over all frames: for each vertex, in order of ids, whether
/// that whole lasts.
std::map<VertexId, bool> lasting(const MotionGraph& motion, int frames, bool doubting) {
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
  const double usual = median(gains);
  const std::size_t end = motion.sketch.frames.size() - 1;
  std::map<VertexId, bool> result;
  for (const auto& [id, i] : index) {
    const std::size_t root = wholes.find_set(i);
    // At the clip's ends nobody knows how long it was there.
    const double least = first[root] == 0 || last[root] == end
                             ? 1
                             : frames * (doubting ? doubted(gain[root] / patches[root], usual) : 1);
    result.emplace(id, static_cast<double>(last[root] - first[root] + 1) > least);
  }
  return result;
}

/// Vertices that were put in are not in `lasts`: they stay; so do strokes that were mended.
void leave_out(std::vector<Draft>& drafts, const std::map<VertexId, bool>& lasts,
               const std::set<SubgraphId>& mended) {
  for (Draft& draft : drafts) {
    std::set<VertexId> gone;
    for (const Vertex& v : draft.vertices) {
      const auto known = lasts.find(v.id);
      if (known != lasts.end() && !known->second && !mended.contains(v.subgraph)) gone.insert(v.id);
    }
    take_out(draft, gone);
  }
}

// ---- what is missing, cut or torn for a moment ----

std::vector<std::uint32_t> members(const AttributeGraph& graph, SubgraphId stroke) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    if (graph.vertices()[i].subgraph == stroke) result.push_back(i);
  }
  return result;
}

/// Mean distance from the patches of one stroke to the nearest one of the other, of their kind.
double apart(const AttributeGraph& a, std::span<const std::uint32_t> of_a, const AttributeGraph& b,
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

/// Puts a stroke of frame `from` into the frames [first, last) too. Its vertices there get ids above all
/// others.
void put_in(std::vector<Draft>& drafts, const AttributeGraph& from, std::span<const std::uint32_t> stroke,
            int first, int last, std::uint32_t& next_id) {
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

/// Whether the edge is all that holds its two ends together.
bool divides(const std::multimap<VertexId, VertexId>& neighbours, Edge edge) {
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

/// Takes out the edge nearest to the place whose loss divides the stroke.
void cut(Draft& draft, SubgraphId stroke, Point place) {
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
  const auto first =
      std::find_if(near.begin(), near.end(), [&](const auto& n) { return divides(neighbours, n.second); });
  if (first != near.end()) draft.edges.erase(first->second);
}

/// Joins two of these strokes by their nearest patches, nearer than `widest` px; where there are more than
/// two, near the place.
void mend(Draft& draft, std::span<const SubgraphId> strokes, Point place, double widest) {
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

void take_out(Draft& draft, SubgraphId stroke) {
  std::set<VertexId> gone;
  for (const Vertex& v : draft.vertices) {
    if (v.subgraph == stroke) gone.insert(v.id);
  }
  take_out(draft, gone);
}

bool unites(const Event& e) {
  return e.type == EventType::merge || e.type == EventType::connect;
}
bool separates(const Event& e) {
  return e.type == EventType::split || e.type == EventType::disconnect;
}

/// Each event and the one that undoes it at most `frames` frames later. Every event undoes or is undone once.
class Undoing {
 public:
  Undoing(const MotionGraph& motion, const std::map<VertexId, bool>& lasts, int frames)
      : motion_(motion), lasts_(lasts), events_(stroke_events(motion)), frames_(frames) {}

  /// Returns the strokes of which what was missing was put in.
  std::set<SubgraphId> mend_all(std::vector<Draft>& drafts) {
    std::uint32_t next_id = 0;
    for (const Draft& d : drafts) {
      for (const Vertex& v : d.vertices) next_id = std::max(next_id, v.id.value + 1);
    }
    std::set<SubgraphId> mended;
    std::vector<bool> undone(events_.size(), false);
    crumbs(drafts, undone);
    // The shortest first: of three changes to and fro the two that lie nearest undo each other.
    for (int apart = 1; apart <= frames_; ++apart) {
      for (std::size_t i = 0; i < events_.size(); ++i) {
        for (std::size_t j = i + 1; j < events_.size() && events_[j].frame <= events_[i].frame + apart; ++j) {
          if (undone[i] || undone[j] || events_[j].frame != events_[i].frame + apart ||
              !undo(drafts, events_[i], events_[j], next_id))
            continue;
          undone[i] = undone[j] = true;
          if (events_[i].type == EventType::death) mended.insert({events_[i].before[0], events_[j].after[0]});
        }
      }
    }
    return mended;
  }

 private:
  /// A piece that parts from a stroke and soon dies is the stroke's end that fades; one that is born and soon
  /// joins another, its beginning: no stroke of its own. If all pieces die soon, the stroke fades as a whole.
  void crumbs(std::vector<Draft>& drafts, std::vector<bool>& undone) const {
    for (std::size_t i = 0; i < events_.size(); ++i) {
      if (!separates(events_[i]) && !unites(events_[i])) continue;
      const Event& joint = events_[i];
      const bool parts = separates(joint);
      const auto& pieces = parts ? joint.after : joint.before;
      if (pieces.size() != 2 || undone[i]) continue;
      // The frames in which a piece stands alone, if it is for so short a time.
      const std::array ends = {lone_end(pieces[0], joint.frame, parts),
                               lone_end(pieces[1], joint.frame, parts)};
      const auto& there =
          motion_.sketch.frames[static_cast<std::size_t>(parts ? joint.frame : joint.frame - 1)];
      const std::array sizes = {members(there, pieces[0]).size(), members(there, pieces[1]).size()};
      const auto frames_of = [&](int end) {
        return std::pair(std::min(joint.frame, end), std::max(joint.frame, end));
      };
      if (ends[0] && ends[1]) {
        const int end = parts ? std::min(*ends[0], *ends[1]) : std::max(*ends[0], *ends[1]);
        const auto [first, last] = frames_of(end);
        for (int t = first; t < last; ++t)
          mend(drafts[static_cast<std::size_t>(t)], pieces, joint.position, kWidestTear);
        undone[i] = true;
        continue;
      }
      for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        if (!ends[k] || sizes[k] > sizes[1 - k]) continue;
        const auto [first, last] = frames_of(*ends[k]);
        for (int t = first; t < last; ++t) take_out(drafts[static_cast<std::size_t>(t)], pieces[k]);
        undone[i] = true;
      }
    }
  }

  /// The frame of the piece's death (birth, where it is one of those that unite), if that is near.
  [[nodiscard]] std::optional<int> lone_end(SubgraphId piece, int frame, bool parts) const {
    for (const Event& e : events_) {
      if (parts && e.type == EventType::death && e.before[0] == piece && e.frame - frame <= frames_)
        return e.frame;
      if (!parts && e.type == EventType::birth && e.after[0] == piece && frame - e.frame <= frames_)
        return e.frame;
    }
    return std::nullopt;
  }

  bool undo(std::vector<Draft>& drafts, const Event& first, const Event& second,
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
    if (separates(first) && unites(second) && (first.after == second.before || (shared() && same_place))) {
      std::vector<SubgraphId> pieces = first.after;
      pieces.insert(pieces.end(), second.before.begin(), second.before.end());
      each([&](Draft& draft) { mend(draft, pieces, first.position, same_place ? kWidestGap : kWidestTear); });
      return true;
    }
    if (unites(first) && separates(second) && first.after == second.before && same_place) {
      each([&](Draft& draft) { cut(draft, first.after[0], first.position); });
      return true;
    }
    if (first.type == EventType::death && second.type == EventType::birth &&
        distance(first.position, second.position) < kNearMiddle) {
      const AttributeGraph& before = motion_.sketch.frames[static_cast<std::size_t>(first.frame - 1)];
      const AttributeGraph& after = motion_.sketch.frames[static_cast<std::size_t>(second.frame)];
      const auto gone = members(before, first.before[0]), back = members(after, second.after[0]);
      if (!lasts_.at(before.vertices()[gone.front()].id) || !lasts_.at(after.vertices()[back.front()].id))
        return false;
      if (apart(before, gone, after, back) > kSameStroke || apart(after, back, before, gone) > kSameStroke)
        return false;
      put_in(drafts, before, gone, first.frame, second.frame, next_id);
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

SketchSequence steady(const MotionGraph& motion, int frames) {
  if (motion.sketch.frames.empty() || frames <= 0) return motion.sketch;
  const std::map<VertexId, bool> lasts = lasting(motion, frames, false);
  std::vector<Draft> changed = drafts(motion.sketch);
  const std::set<SubgraphId> mended = Undoing(motion, lasts, frames).mend_all(changed);
  leave_out(changed, lasting(motion, frames, true), mended);
  SketchSequence result{motion.sketch.width, motion.sketch.height, motion.sketch.fps, {}};
  for (const Draft& draft : changed) result.append(draft.graph());
  return result;
}

}  // namespace emberfold::graph
