// SPDX-License-Identifier: Apache-2.0
#include "graph/events/topology_changes.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <map>
#include <tuple>

#include "graph/events/believed_lives.hpp"
#include "graph/events/tip_links.hpp"

namespace emberfold::graph {

namespace {

/// The counts of a cluster in one frame.
struct Counts {
  int tips = 0, branches = 0, components = 0, loops = 0;
};

/// Counts and changes of linked strokes between two frames.
struct ClusterBook {
  Counts before, after;
  std::vector<TopologyChange> changes;
  std::vector<std::uint32_t> lost_tips, new_tips;  ///< without a partner in the other frame
};

void count_vertices(const AttributeGraph& graph, const std::vector<std::uint32_t>& cluster,
                    std::vector<ClusterBook>& books, Counts ClusterBook::*frame) {
  const Components parts = components(graph);
  std::vector<bool> is_counted(parts.count, false);
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    Counts& counts = books[cluster[v]].*frame;
    const auto degree = static_cast<int>(graph.degree(v));
    counts.tips += degree == 0 ? 2 : degree == 1 ? 1 : 0;
    counts.branches += std::max(0, degree - 2);
    counts.loops -= 1;  // loops = edges − vertices + components
    if (!is_counted[parts.of_vertex[v]]) {
      is_counted[parts.of_vertex[v]] = true;
      ++counts.components, ++counts.loops;
    }
  }
  for (const Edge& edge : graph.edges()) ++(books[cluster[graph.index_of(edge.a)]].*frame).loops;
}

/// Returns how many tips a contact takes up.
int tips_taken(Contact contact) {
  return contact == Contact::tip_tip ? 2 : contact == Contact::tip_side ? 1 : 0;
}
Contact contact_taking(int tips) {
  constexpr std::array kContacts{Contact::side_side, Contact::tip_side, Contact::tip_tip};
  return kContacts.at(static_cast<std::size_t>(tips));
}

TopologyChange change_of(const Event& event, Contact contact, bool at_border) {
  TopologyChange change;
  change.frame = event.frame;
  change.change = static_cast<Change>(event.type);
  change.position = event.position;
  change.contact = contact;
  using enum EventType;
  if (event.type == birth || event.type == death) {
    change.components = event.type == birth ? 1 : -1;
    change.tips = 2 * change.components;
    if (at_border) change.change = event.type == birth ? Change::enters : Change::leaves;
    return change;
  }
  change.components = event.type == split || event.type == disconnect ? 1 : -1;
  change.tips = change.components * tips_taken(contact);
  change.branches = -change.components * (2 - tips_taken(contact));
  return change;
}

/// Finds places for the changes that a cluster's books lack, and adds them.
class BookCloser {
 public:
  BookCloser(const AttributeGraph& before, const AttributeGraph& after, const detail::FrameClusters& clusters)
      : before_(before), after_(after), clusters_(clusters) {}

  void close(ClusterBook& book, std::uint32_t cluster, int frame) const {
    int tips = book.after.tips - book.before.tips;
    for (const TopologyChange& change : book.changes) tips -= change.tips;
    const int loops = book.after.loops - book.before.loops, sense = loops > 0 ? 1 : -1;
    std::vector<TopologyChange> rings;
    for (int k = 0; k < std::abs(loops); ++k) {
      // A ring that closes takes up to two tips, one that opens leaves as many.
      const int taken = std::clamp(-sense * tips, 0, 2);
      TopologyChange ring;
      ring.frame = frame;
      ring.change = loops > 0 ? Change::ring_closed : Change::ring_opened;
      ring.contact = contact_taking(taken);
      ring.loops = sense;
      ring.tips = -sense * taken;
      ring.branches = sense * (2 - taken);
      tips -= ring.tips;
      rings.push_back(ring);
    }
    add_branches(book, cluster, frame, tips);
    for (TopologyChange& ring : rings) {
      ring.position = place_of_ring(book, cluster, ring);
      book.changes.push_back(ring);
    }
  }

 private:
  void add_branches(ClusterBook& book, std::uint32_t cluster, int frame, int count) const {
    const bool grew = count > 0;
    const AttributeGraph& graph = grew ? after_ : before_;
    for (int k = 0; k < std::abs(count); ++k) {
      TopologyChange branch;
      branch.frame = frame;
      branch.change = grew ? Change::branch_extruded : Change::branch_retracted;
      branch.tips = branch.branches = grew ? 1 : -1;
      auto& tips = grew ? book.new_tips : book.lost_tips;
      const auto tip = std::ranges::max_element(tips, {}, [&](std::uint32_t v) {
        double nearest = std::numeric_limits<double>::max();
        for (const TopologyChange& other : book.changes)
          nearest = std::min(nearest, distance(other.position, graph.patch(v).position));
        return nearest;
      });
      if (tip == tips.end()) {
        branch.position = middle_of(graph, grew ? clusters_.of_after : clusters_.of_before, cluster);
      } else {
        branch.position = graph.patch(*tip).position;
        const auto way = detail::way_from_tip(graph, *tip);
        for (std::size_t i = 1; i < way.size(); ++i)
          branch.length += distance(graph.patch(way[i - 1]).position, graph.patch(way[i]).position);
        tips.erase(tip);
      }
      book.changes.push_back(branch);
    }
  }

  [[nodiscard]] Point place_of_ring(ClusterBook& book, std::uint32_t cluster,
                                    const TopologyChange& ring) const {
    const bool closed = ring.change == Change::ring_closed;
    auto& tips = closed ? book.lost_tips : book.new_tips;
    const AttributeGraph& graph = closed ? before_ : after_;
    if (ring.contact != Contact::side_side && !tips.empty()) {
      const Point place = graph.patch(tips.back()).position;
      tips.pop_back();
      return place;
    }
    return middle_of(closed ? after_ : before_, closed ? clusters_.of_after : clusters_.of_before, cluster);
  }

  static Point middle_of(const AttributeGraph& graph, const std::vector<std::uint32_t>& of_vertex,
                         std::uint32_t cluster) {
    Point sum;
    double count = 0;
    for (std::uint32_t v = 0; v < graph.size(); ++v)
      if (of_vertex[v] == cluster) sum = sum + graph.patch(v).position, ++count;
    return count > 0 ? sum * (1 / count) : sum;
  }

  const AttributeGraph &before_, &after_;
  const detail::FrameClusters& clusters_;
};

/// Marks the tips that have no partner in the other frame.
void find_loose_tips(const AttributeGraph& before, const AttributeGraph& after, std::span<const Link> links,
                     const detail::FrameClusters& clusters, std::vector<ClusterBook>& books) {
  std::vector<bool> goes_on(before.size(), false), was_there(after.size(), false);
  for (const auto& [i, j] : detail::link_tips(before, after, links, clusters))
    goes_on[i] = was_there[j] = true;
  for (const std::uint32_t v : detail::tips_of(before))
    if (!goes_on[v]) books[clusters.of_before[v]].lost_tips.push_back(v);
  for (const std::uint32_t v : detail::tips_of(after))
    if (!was_there[v]) books[clusters.of_after[v]].new_tips.push_back(v);
}

struct NamedEvent {
  TracedEvent traced;
  Contact contact = Contact::none;
  bool at_border = false;  ///< of a birth or a death
};

/// Returns whether a stroke of a frame is a ring that the picture's border cuts off.
bool is_cut_off(const SketchSequence& sketch, SubgraphId stroke, std::size_t frame) {
  constexpr double kAtBorder = 3;  // px; outlines that are cut off run along the border. Set by hand
  const AttributeGraph& graph = sketch.frames[frame];
  bool touches = false;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (graph.vertices()[v].subgraph != stroke) continue;
    if (graph.degree(v) < 2) return false;
    touches |= detail::distance_to_border(sketch, graph.patch(v).position) < kAtBorder;
  }
  return touches;
}

/// Returns whether the stroke that an event begins came in through the border, or the one it ends went out.
bool is_at_border(const SketchSequence& sketch, const std::map<SubgraphId, detail::Life>& lives,
                  const Event& event) {
  const auto frame = static_cast<std::size_t>(event.frame);
  if (event.type == EventType::birth) {
    const SubgraphId stroke = event.after.front();
    const detail::Life& life = lives.at(stroke);
    return (life.first == frame && life.comes_in) || is_cut_off(sketch, stroke, frame);
  }
  if (event.type != EventType::death) return false;
  const SubgraphId stroke = event.before.front();
  const detail::Life& life = lives.at(stroke);
  return (life.last + 1 == frame && life.goes_out) || is_cut_off(sketch, stroke, frame - 1);
}

/// Adds the changes between two frames. `events`: of this frame.
void add_frame_changes(const MotionGraph& motion, std::size_t t, std::span<const NamedEvent> events,
                       std::vector<TopologyChange>& changes) {
  const AttributeGraph &before = motion.sketch.frames[t - 1], &after = motion.sketch.frames[t];
  const auto clusters = detail::cluster_frames(before, after, motion.links[t]);
  std::vector<ClusterBook> books(clusters.count);
  count_vertices(before, clusters.of_before, books, &ClusterBook::before);
  count_vertices(after, clusters.of_after, books, &ClusterBook::after);
  for (const auto& [traced, contact, at_border] : events) {
    const bool in_after = traced.path_frame == static_cast<int>(t);
    const std::size_t vertex = (in_after ? after : before).index_of(traced.path.front());
    books[(in_after ? clusters.of_after : clusters.of_before)[vertex]].changes.push_back(
        change_of(traced.event, contact, at_border));
  }
  find_loose_tips(before, after, motion.links[t], clusters, books);
  const BookCloser closer(before, after, clusters);
  for (std::uint32_t c = 0; c < books.size(); ++c) {
    closer.close(books[c], c, static_cast<int>(t));
    changes.insert(changes.end(), books[c].changes.begin(), books[c].changes.end());
  }
}

}  // namespace

std::string_view name(Change change) {
  constexpr std::array<std::string_view, 13> kNames{
      "birth",      "death",       "split",       "merge",           "connect",
      "disconnect", "ring_closed", "ring_opened", "branch_extruded", "branch_retracted",
      "enters",     "leaves",      "t1"};
  return kNames.at(static_cast<std::size_t>(change));
}

std::vector<TopologyChange> topology_changes(const MotionGraph& motion) {
  auto traced = trace_stroke_events(motion);
  std::vector<Event> events;
  for (const TracedEvent& one : traced) events.push_back(one.event);
  const auto contacts = event_contacts(motion, events);
  const std::size_t frames = motion.sketch.frames.size();
  const auto lives = detail::believed_lives(motion, detail::Believed(frames + 1), {});
  std::vector<std::vector<NamedEvent>> by_frame(frames);
  for (std::size_t k = 0; k < traced.size(); ++k)
    by_frame[static_cast<std::size_t>(traced[k].event.frame)].push_back(
        {std::move(traced[k]), contacts[k], is_at_border(motion.sketch, lives, events[k])});
  auto changes = find_neighbour_swaps(motion);
  for (std::size_t t = 1; t < by_frame.size(); ++t) add_frame_changes(motion, t, by_frame[t], changes);
  std::ranges::stable_sort(changes, {}, [](const TopologyChange& c) {
    return std::tuple(c.frame, c.change, c.position.x, c.position.y);
  });
  return changes;
}

}  // namespace emberfold::graph
