// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::mcmc {

/// Names a node of a HiddenGraph.
using Index = std::uint32_t;
constexpr Index kNone = ~Index{0};

/// A few indices, in order of insertion. Taking out and undoing it leaves them as they were.
template <std::size_t Most>
class ShortList {
 public:
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] bool full() const { return count_ == Most; }
  [[nodiscard]] const Index* begin() const { return items_.data(); }
  [[nodiscard]] const Index* end() const { return items_.data() + count_; }
  Index operator[](std::size_t i) const { return items_[i]; }
  [[nodiscard]] bool has(Index x) const { return find(x) < count_; }
  [[nodiscard]] std::size_t find(Index x) const {
    std::size_t i = 0;
    while (i < count_ && items_[i] != x) ++i;
    return i;
  }
  void insert(std::size_t at, Index x) {
    for (std::size_t i = count_++; i > at; --i) items_[i] = items_[i - 1];
    items_[at] = x;
  }
  void push(Index x) { items_[count_++] = x; }
  /// Returns where it was.
  std::size_t erase(Index x) {
    const std::size_t at = find(x);
    --count_;
    for (std::size_t i = at; i < count_; ++i) items_[i] = items_[i + 1];
    items_[count_] = 0;
    return at;
  }
  bool operator==(const ShortList&) const = default;

 private:
  std::array<Index, Most> items_{};
  std::uint8_t count_ = 0;
};

/// No patch has more; the state space ends there.
constexpr std::size_t kMostEdges = 12, kMostLinks = 6;

/// How two nodes of a frame lie to each other, by distance and by whether they lie in line: what the
/// probability of an edge depends on.
constexpr std::size_t kCloseness = 6;

/// A node nearby in the same frame.
struct NeighbourCandidate {
  Index node = 0;
  std::uint8_t closeness = 0;  ///< below kCloseness
  bool earlier = false;        ///< it comes before the one that it lies beside (HiddenGraph::before)
  float evidence = 0;          ///< nats that the image gives for an edge between them
};

/// How a node would have moved and changed as one of the next frame.
struct TransitionOffset {
  double across = 0, along = 0;  ///< px, from where drift carries it: along the normal, along the curve
  double turn = 0;               ///< rad, undirected, −π/2…π/2
  double flicker = 0;            ///< of the logarithm of the contrast
  double sense = 1;              ///< −1 where their normals point to opposite sides
  double log_appearance = 0;     ///< stored by Density::prepare
};

/// What a patch shows that its successor must show too.
enum class Kind : std::uint8_t { bright, dark, step };
Kind kind(const graph::Patch& patch);

/// A patch that may be in the graph of its frame. What is asked most often comes first: a sampler goes
/// through nodes at random, and memory is what it waits for.
struct alignas(64) Node {
  // What changes while it is `on`:
  ShortList<kMostLinks> next, prev;  ///< links to nodes of the frame after and before
  bool active = false;
  std::uint8_t overlapped = 0;  ///< by how many nodes that are on
  // What does not:
  std::uint8_t place = 0;  ///< level of the death map here, below kPlaces
  bool border = false;     ///< within kBorder of the frame's border, or outside
  Kind kind = Kind::bright;
  // Again what does:
  ShortList<kMostEdges> edges;
  double displacement = 0;  ///< px, latent: displacement from rest along the normal (−sin θ, cos θ)
  // And what does not:
  double evidence = 0;      ///< nats that showing it saves
  graph::Point tangent;     ///< unit, of the patch's direction
  double log_contrast = 0;  ///< of 1 + |contrast|
  double order = 0;         ///< nodes of a frame are passed in ascending order of this, then of index
  double log_birth = 0;     ///< of the birth map here over its mean; −∞: nothing begins
  int frame = 0;
  graph::Point drift;  ///< px a frame: how rest travels here
  graph::Patch patch;

  [[nodiscard]] graph::Point normal() const { return {-tangent.y, tangent.x}; }
};
constexpr double kBorder = 8;       ///< px
constexpr std::size_t kPlaces = 9;  ///< levels of the death map: 1/4, … by √2 …, 4

/// Which nodes may be joined, linked, shown together. px.
struct Gates {
  double edge = 12;    ///< nodes of a frame farther apart are not joined
  double link = 12;    ///< nodes of neighbouring frames farther apart are not linked
  double overlap = 3;  ///< nodes of a frame and kind nearer to each other are not both on; 0: they may
};

/// The turn from a to b, undirected: −π/2…π/2.
double turn_between(const Node& a, const Node& b);

/// The state of the sampler: of a fixed set of candidate patches in every frame those that are in the graph,
/// their edges, the links between frames (a star forest in each gap), and how far each patch displacements. What
/// candidates could be joined or linked is known beforehand. Operations do what they are told; whether they
/// may is asked of can_link and can_join.
class HiddenGraph {
 public:
  HiddenGraph(int width, int height, int frames, const Gates& gates);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int frames() const { return static_cast<int>(active_.size()); }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] const Node& operator[](Index i) const { return nodes_[i]; }
  /// Nodes of a frame that are on, or off, in no order that matters.
  [[nodiscard]] std::span<const Index> active(int frame) const { return active_[static_cast<std::size_t>(frame)]; }
  [[nodiscard]] std::span<const Index> inactive(int frame) const { return inactive_[static_cast<std::size_t>(frame)]; }
  /// Nodes, on or off, within the edge's gate in the same frame; symmetric.
  [[nodiscard]] std::span<const NeighbourCandidate> neighbours(Index i) const { return neighbours_[i]; }
  /// Of those, the ones of its kind that it could merge into, being close and earlier; and those that could
  /// merge into it.
  [[nodiscard]] std::span<const Index> hosts(Index i) const { return hosts_[i]; }
  [[nodiscard]] std::span<const Index> guests(Index i) const { return guests_[i]; }
  /// Nodes of the same kind, on or off, within the link's gate one frame on, and one back.
  [[nodiscard]] std::span<const Index> candidates_after(Index i) const { return candidates_after_[i]; }
  [[nodiscard]] std::span<const Index> candidates_before(Index i) const { return candidates_before_[i]; }
  /// How it would go on as each of those ahead.
  [[nodiscard]] std::span<const TransitionOffset> offsets(Index i) const { return offsets_[i]; }
  [[nodiscard]] std::span<TransitionOffset> offsets(Index i) { return offsets_[i]; }
  /// Of two nodes that can be linked.
  [[nodiscard]] const TransitionOffset& offset(Index v, Index w) const {
    const auto& list = candidates_after_[v];
    std::size_t k = 0;
    while (list[k] != w) ++k;
    return offsets_[v][k];
  }
  [[nodiscard]] bool linkable(Index v, Index w) const;
  [[nodiscard]] bool precedes(Index a, Index b) const {
    return nodes_[a].order != nodes_[b].order ? nodes_[a].order < nodes_[b].order : a < b;
  }
  // What Node tells too, a byte a node.
  [[nodiscard]] bool is_active(Index i) const { return (flags_[i] & kActive) != 0; }
  [[nodiscard]] bool has_past(Index i) const { return (flags_[i] & kPast) != 0; }
  [[nodiscard]] bool has_future(Index i) const { return (flags_[i] & kFuture) != 0; }
  [[nodiscard]] bool has_room(Index i) const { return (flags_[i] & kCrowded) == 0; }  ///< for an edge
  /// On, and its only link leads to a node whose parent it is.
  [[nodiscard]] bool continues(Index i) const { return (flags_[i] & kContinues) != 0; }

  /// A new candidate, off. O(candidates nearby).
  Index add_candidate(int frame, const graph::Patch& patch);
  /// Takes back the newest candidate; it is off.
  void drop_newest_candidate();
  /// Lets two nodes of a frame be joined whatever their distance.
  void allow_edge(Index a, Index b);
  void set_edge_evidence(Index a, Index b, double nats);
  void allow_link(Index before, Index after);
  [[nodiscard]] bool overlaps(Index a, Index b) const;
  /// What the maps say of its place.
  void set_map_values(Index i, double log_birth, std::uint8_t place, graph::Point drift);
  void set_evidence(Index i, double nats) { nodes_[i].evidence = nats; }

  [[nodiscard]] bool can_activate(Index i) const { return !nodes_[i].active && nodes_[i].overlapped == 0; }
  /// Both on, of neighbouring frames, not linked, and the links stay a star forest.
  [[nodiscard]] bool can_link(Index v, Index w) const;
  [[nodiscard]] bool can_add_edge(Index a, Index b) const {
    return a != b && is_active(a) && is_active(b) && has_room(a) && has_room(b) && !nodes_[a].edges.has(b);
  }

  void link(Index v, Index w);
  void add_edge(Index a, Index b);
  void activate(Index i);                                                              ///< on, alone
  void set_displacement(Index i, double displacement) { nodes_[i].displacement = displacement == 0 ? 0 : displacement; }  // no −0
  /// The places in the lists from which things were taken: what undoing needs.
  struct Places {
    std::size_t first = 0, second = 0;
  };
  Places unlink(Index v, Index w);
  Places remove_edge(Index a, Index b);
  Places deactivate(Index i);  ///< off; it has neither edges nor links
  void undo_unlink(Index v, Index w, Places at);
  void undo_remove_edge(Index a, Index b, Places at);
  void undo_deactivate(Index i, Places at);
  [[nodiscard]] Places inactive_place(Index i) const;  ///< before put(), for undo_activate()
  void undo_activate(Index i, Places at);

  /// Of what is on, with edges, links and displacement, whatever the order of lists. Equal states have equal hashes.
  [[nodiscard]] std::uint64_t hash() const;
  bool operator==(const HiddenGraph& o) const;

 private:
  enum Flag : std::uint8_t { kActive = 1, kPast = 2, kFuture = 4, kContinues = 8, kCrowded = 16 };
  void flag(Index i, Flag which, bool holds);
  void flag_links(Index v, Index w);
  void flag_edges(Index a, Index b);
  void set_active(Index i, bool active);
  [[nodiscard]] bool is_parent(Index v, Index w) const {
    const auto& prev = nodes_[w].prev;
    return std::all_of(prev.begin(), prev.end(), [&](Index x) { return x == v || precedes(v, x); });
  }
  [[nodiscard]] bool can_merge(Index a, const NeighbourCandidate& b) const {
    return b.closeness < 2 && nodes_[a].kind == nodes_[b.node].kind;
  }
  void add_neighbours(Index a, Index b);
  void add_link_candidate(Index v, Index w);
  void count_overlaps(Index i, int change);
  [[nodiscard]] TransitionOffset make_offset(Index v, Index w) const;
  [[nodiscard]] std::size_t cell(int frame, int column, int row) const;
  [[nodiscard]] std::size_t cell(int frame, graph::Point p) const;
  template <class Visit>
  void visit_near(int frame, graph::Point p, Visit visit) const;

  int width_, height_;
  Gates gates_;
  std::vector<Node> nodes_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::vector<NeighbourCandidate>> neighbours_;
  std::vector<std::vector<Index>> hosts_, guests_, candidates_after_, candidates_before_;
  std::vector<std::vector<TransitionOffset>> offsets_;
  std::vector<std::vector<Index>> active_, inactive_;  ///< by frame
  std::vector<std::vector<Index>> cells_;     ///< all nodes, by frame, row and column
  int columns_ = 1, rows_ = 1;
  double cell_ = 1;        ///< px
  std::vector<Index> at_;  ///< place in active_ or inactive_
};

/// A state whose candidates are the patches of `start`, on as it has them, and off those of the others that
/// overlap none of the former. Edges and links beyond the gates are allowed where the start has them.
/// InputError where clips differ in size or length. O(patches log).
HiddenGraph hidden_graph(const graph::MotionGraph& start, std::span<const graph::SketchSequence> others,
                         const Gates& gates);

/// What is on, as a motion graph with its strokes identified; without links between strokes that too few hold
/// together, as the match leaves them out (graph::supported_links).
graph::MotionGraph motion_graph(const HiddenGraph& state, double fps);

}  // namespace emberfold::mcmc
