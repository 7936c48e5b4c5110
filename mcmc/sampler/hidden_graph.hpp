// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::mcmc {

/// Index of a node of a HiddenGraph.
using Index = std::uint32_t;
constexpr Index kNone = ~Index{0};

/// Holds up to `Most` indices in order of insertion. Undoing an erasure restores the order.
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
  /// Removes x and returns its place.
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

/// Largest numbers of edges and links of a patch; the state space ends there.
constexpr std::size_t kMostEdges = 12, kMostLinks = 6;

/// Number of classes of the position of two nodes, by distance and collinearity. An edge's probability
/// depends on it.
constexpr std::size_t kCloseness = 6;

/// Holds a node near another one in the same frame.
struct NeighbourCandidate {
  Index node = 0;
  std::uint8_t closeness = 0;  ///< below kCloseness
  bool earlier = false;        ///< it precedes the node whose neighbour it is (HiddenGraph::precedes)
  bool together = false;       ///< both may be on though they overlap
  float evidence = 0;          ///< nats, for an edge between them
};

/// Holds how a node would move and change if it continued as a given node of the next frame.
struct TransitionOffset {
  double across = 0, along = 0;  ///< px, from where drift carries it: along the normal, along the curve
  double turn = 0;               ///< rad, undirected, −π/2…π/2
  double flicker = 0;            ///< of the logarithm of the contrast
  double sense = 1;              ///< −1 where their normals point to opposite sides
  double log_appearance = 0;     ///< stored by Density::prepare
};

/// Class of a patch's profile; a successor must have the same.
enum class Kind : std::uint8_t { bright, dark, step };
Kind kind(const graph::Patch& patch);

/// Holds a patch that may be in the graph of its frame.
/// Fields are ordered by how often they are read: the sampler visits nodes at random, and memory limits its
/// speed.
struct alignas(64) Node {
  // Changes while the node is on:
  ShortList<kMostLinks> next, prev;  ///< links to nodes of the frame after and before
  bool active = false;
  std::uint8_t overlapped = 0;  ///< number of nodes on that overlap it
  // Fixed:
  std::uint8_t place = 0;  ///< level of the death map here, below kPlaces
  bool border = false;     ///< within kBorder of the frame's border, or outside
  Kind kind = Kind::bright;
  // Changes:
  ShortList<kMostEdges> edges;
  double displacement = 0;  ///< px, latent: displacement from rest along the normal (−sin θ, cos θ)
  // Fixed:
  double evidence = 0;      ///< nats saved by drawing it
  graph::Point tangent;     ///< unit, of the patch's direction
  double log_contrast = 0;  ///< of 1 + |contrast|
  double order = 0;         ///< nodes of a frame are ordered by this, then by index
  double log_birth = 0;     ///< of the birth map here over its mean; −∞: nothing begins
  int frame = 0;
  graph::Point drift;  ///< px a frame: velocity of rest shapes here
  graph::Patch patch;

  [[nodiscard]] graph::Point normal() const { return {-tangent.y, tangent.x}; }
};
constexpr double kBorder = 8;       ///< px
constexpr std::size_t kPlaces = 9;  ///< levels of the death map: 1/4, … by √2 …, 4

/// Holds the distances, px, within which nodes may be joined, linked, or on together.
struct Gates {
  double edge = 12;    ///< nodes of a frame farther apart are not joined
  double link = 12;    ///< nodes of neighbouring frames farther apart are not linked
  double overlap = 3;  ///< nodes of a frame and kind nearer to each other are not both on; 0: they may
};

/// Returns the turn from a to b, undirected, rad: −π/2…π/2.
double turn_between(const Node& a, const Node& b);

/// Holds the state of the sampler over a fixed set of candidate patches in every frame.
/// The state is which candidates are in the graph, their edges, the links between frames (a star forest in
/// each gap), and each patch's displacement. Candidate neighbours and links are found once. Operations do not
/// check; ask can_link() and can_add_edge() before.
class HiddenGraph {
 public:
  HiddenGraph(int width, int height, int frames, const Gates& gates);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int frames() const { return static_cast<int>(active_.size()); }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] const Node& operator[](Index i) const { return nodes_[i]; }
  /// Returns the nodes of a frame that are on, or off, in no particular order.
  [[nodiscard]] std::span<const Index> active(int frame) const {
    return active_[static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] std::span<const Index> inactive(int frame) const {
    return inactive_[static_cast<std::size_t>(frame)];
  }
  /// Lists the nodes, on or off, within the edge gate in the same frame; symmetric.
  [[nodiscard]] std::span<const NeighbourCandidate> neighbours(Index i) const { return neighbours_[i]; }
  /// Lists the close, earlier neighbours of its kind, into which it could merge.
  [[nodiscard]] std::span<const Index> hosts(Index i) const { return hosts_[i]; }
  /// Lists the neighbours that could merge into it.
  [[nodiscard]] std::span<const Index> guests(Index i) const { return guests_[i]; }
  /// Lists the nodes of the same kind, on or off, within the link gate one frame ahead.
  [[nodiscard]] std::span<const Index> candidates_after(Index i) const { return candidates_after_[i]; }
  /// Lists the nodes of the same kind, on or off, within the link gate one frame back.
  [[nodiscard]] std::span<const Index> candidates_before(Index i) const { return candidates_before_[i]; }
  /// Returns how it would continue as each of candidates_after().
  [[nodiscard]] std::span<const TransitionOffset> offsets(Index i) const { return offsets_[i]; }
  [[nodiscard]] std::span<TransitionOffset> offsets(Index i) { return offsets_[i]; }
  /// Returns the offset of two nodes that can be linked.
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
  // Flags, which repeat parts of Node in one byte a node.
  [[nodiscard]] bool is_active(Index i) const { return (flags_[i] & kActive) != 0; }
  [[nodiscard]] bool has_past(Index i) const { return (flags_[i] & kPast) != 0; }
  [[nodiscard]] bool has_future(Index i) const { return (flags_[i] & kFuture) != 0; }
  [[nodiscard]] bool has_room(Index i) const { return (flags_[i] & kCrowded) == 0; }  ///< for an edge
  /// Returns whether it is on and its only link leads to a node whose parent it is.
  [[nodiscard]] bool continues(Index i) const { return (flags_[i] & kContinues) != 0; }

  /// Adds a candidate, off. O(candidates nearby).
  Index add_candidate(int frame, const graph::Patch& patch);
  /// Removes the newest candidate, which is off.
  void drop_newest_candidate();
  /// Allows an edge between two nodes of a frame at any distance.
  void allow_edge(Index a, Index b);
  void set_edge_evidence(Index a, Index b, double nats);
  void allow_link(Index before, Index after);
  /// Lets two nodes of a frame that overlap be on together. Both must be off.
  void allow_together(Index a, Index b);
  [[nodiscard]] bool overlaps(Index a, Index b) const;
  /// Sets the values of the maps at its place.
  void set_map_values(Index i, double log_birth, std::uint8_t place, graph::Point drift);
  void set_evidence(Index i, double nats) { nodes_[i].evidence = nats; }

  [[nodiscard]] bool can_activate(Index i) const { return !nodes_[i].active && nodes_[i].overlapped == 0; }
  /// Returns whether both are on, in neighbouring frames, not linked, and a link keeps a star forest.
  [[nodiscard]] bool can_link(Index v, Index w) const;
  [[nodiscard]] bool can_add_edge(Index a, Index b) const {
    return a != b && is_active(a) && is_active(b) && has_room(a) && has_room(b) && !nodes_[a].edges.has(b);
  }

  void link(Index v, Index w);
  void add_edge(Index a, Index b);
  void activate(Index i);  ///< on, alone
  void set_displacement(Index i, double displacement) {
    nodes_[i].displacement = displacement == 0 ? 0 : displacement;
  }  // no −0
  /// Holds the places in the lists from which entries were taken, for undoing.
  struct Places {
    std::size_t first = 0, second = 0;
  };
  Places unlink(Index v, Index w);
  Places remove_edge(Index a, Index b);
  Places deactivate(Index i);  ///< off; it has neither edges nor links
  void undo_unlink(Index v, Index w, Places at);
  void undo_remove_edge(Index a, Index b, Places at);
  void undo_deactivate(Index i, Places at);
  [[nodiscard]] Places inactive_place(Index i) const;  ///< before activate(), for undo_activate()
  void undo_activate(Index i, Places at);

  /// Hashes the nodes that are on, their edges, links and displacements, whatever the order of lists.
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
  std::vector<std::vector<Index>> cells_;              ///< all nodes, by frame, row and column
  int columns_ = 1, rows_ = 1;
  double cell_ = 1;        ///< px
  std::vector<Index> at_;  ///< place in active_ or inactive_
};

/// Builds a state of each start, all of them over the same candidates: the patches of all starts.
/// A patch of a later start is the nearest candidate of its kind that it overlaps, if there is one. In each
/// state the patches of its start are on, with their edges and links. Patches that overlap, edges and links
/// beyond the gates are allowed where a start has them. Throws core::InputError for no start, and where clips
/// differ in size or length. O(patches log patches) a start.
std::vector<HiddenGraph> hidden_graphs(std::span<const graph::MotionGraph> starts, const Gates& gates);

/// Returns the nodes that are on as a motion graph, with strokes identified.
/// Links between strokes that too few patches support are left out, as in the match (graph::supported_links).
graph::MotionGraph motion_graph(const HiddenGraph& state, double fps);

}  // namespace emberfold::mcmc
