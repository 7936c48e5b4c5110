// SPDX-License-Identifier: Apache-2.0
#include "mcmc/hidden_graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "graph/match.hpp"
#include "graph/near.hpp"

namespace emberfold::mcmc {

namespace {

using graph::Point;

// Of two patches of a frame: by distance, and whether both lie in one line with less than 30° of turn.
std::uint8_t closeness(const Node& a, const Node& b) {
  const Point apart = b.patch.position - a.patch.position;
  const double distance = graph::norm(apart);
  const double straight = std::sqrt(0.75) * distance;
  const bool aligned = std::abs(graph::dot(apart, a.tangent)) >= straight &&
                       std::abs(graph::dot(apart, b.tangent)) >= straight;
  const std::uint8_t far = distance < 7 ? 0 : distance < 9.5 ? 1 : 2;
  return static_cast<std::uint8_t>(2 * far + (aligned ? 0 : 1));
}

void erase_from(std::vector<Index>& list, std::vector<Index>& at, Index i) {
  list[at[i]] = list.back();
  at[list.back()] = at[i];
  list.pop_back();
}
void append_to(std::vector<Index>& list, std::vector<Index>& at, Index i) {
  at[i] = static_cast<Index>(list.size());
  list.push_back(i);
}
// Puts i back to the place from which erase_from took it.
void put_back(std::vector<Index>& list, std::vector<Index>& at, Index i, std::size_t place) {
  list.push_back(i);
  if (place + 1 < list.size()) {
    list.back() = list[place];
    at[list.back()] = static_cast<Index>(list.size() - 1);
    list[place] = i;
  }
  at[i] = static_cast<Index>(place);
}

std::uint64_t mixed(std::uint64_t x) {
  x ^= x >> 30U, x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27U, x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

template <std::size_t Most>
bool same_set(const ShortList<Most>& a, const ShortList<Most>& b) {
  return a.size() == b.size() && std::ranges::all_of(a, [&](Index x) { return b.has(x); });
}

}  // namespace

Kind kind(const graph::Patch& patch) {
  if (graph::on_step(patch)) return Kind::step;
  return patch.contrast < 0 ? Kind::dark : Kind::bright;
}

HiddenGraph::HiddenGraph(int width, int height, int frames, const Gates& gates)
    : width_(width), height_(height), gates_(gates) {
  on_.resize(static_cast<std::size_t>(frames));
  off_ = on_;
  cell_ = std::max({gates.edge, gates.link, 4.0});
  columns_ = static_cast<int>(width / cell_) + 1, rows_ = static_cast<int>(height / cell_) + 1;
  cells_.resize(on_.size() * static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

std::size_t HiddenGraph::cell(int frame, int column, int row) const {
  return (static_cast<std::size_t>(frame) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row)) *
             static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(column);
}
std::size_t HiddenGraph::cell(int frame, Point p) const {
  return cell(frame, std::clamp(static_cast<int>(p.x / cell_), 0, columns_ - 1),
              std::clamp(static_cast<int>(p.y / cell_), 0, rows_ - 1));
}
template <class Visit>
void HiddenGraph::visit_near(int frame, Point p, Visit visit) const {
  const int column = std::clamp(static_cast<int>(p.x / cell_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(p.y / cell_), 0, rows_ - 1);
  for (int y = std::max(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x)
      for (const Index j : cells_[cell(frame, x, y)]) visit(j);
}

bool HiddenGraph::overlaps(Index a, Index b) const {
  const Point apart = nodes_[a].patch.position - nodes_[b].patch.position;
  return nodes_[a].kind == nodes_[b].kind && graph::dot(apart, apart) < gates_.overlap * gates_.overlap;
}

Index HiddenGraph::add_candidate(int frame, const graph::Patch& patch) {
  const auto i = static_cast<Index>(nodes_.size());
  const Point p = patch.position;
  Node node;
  node.patch = patch;
  node.frame = frame;
  node.tangent = {std::cos(patch.theta), std::sin(patch.theta)};
  node.log_contrast = std::log1p(std::abs(patch.contrast));
  node.order = 0.8 * p.x + 0.6 * p.y;  // no usual direction of lines lies across this
  node.kind = kind(patch);
  node.border = p.x < kBorder || p.y < kBorder || p.x > width_ - 1 - kBorder || p.y > height_ - 1 - kBorder;
  node.place = kPlaces / 2;
  nodes_.push_back(node);
  beside_.emplace_back(), ahead_.emplace_back(), behind_.emplace_back();
  at_.push_back(0);
  const auto t = static_cast<std::size_t>(frame);
  const auto within = [&](Index j, double gate) {
    const Point apart = nodes_[j].patch.position - p;
    return graph::dot(apart, apart) <= gate * gate;
  };
  visit_near(frame, p, [&](Index j) {
    if (!within(j, gates_.edge)) return;
    beside_[i].push_back({j, closeness(nodes_[i], nodes_[j]), 0});
    beside_[j].push_back({i, closeness(nodes_[j], nodes_[i]), 0});
    if (nodes_[j].on && overlaps(i, j)) ++nodes_[i].overlapped;
  });
  const auto linkable = [&](Index j) { return nodes_[j].kind == nodes_[i].kind && within(j, gates_.link); };
  if (t > 0)
    visit_near(frame - 1, p, [&](Index j) {
      if (linkable(j)) behind_[i].push_back(j), ahead_[j].push_back(make_ahead(j, i));
    });
  if (t + 1 < on_.size())
    visit_near(frame + 1, p, [&](Index j) {
      if (linkable(j)) ahead_[i].push_back(make_ahead(i, j)), behind_[j].push_back(i);
    });
  cells_[cell(frame, p)].push_back(i);
  append_to(off_[t], at_, i);
  return i;
}

void HiddenGraph::drop_newest_candidate() {
  const auto i = static_cast<Index>(nodes_.size() - 1);
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  // The newest is the last in every list that it is in.
  for (const Beside& near : beside_[i]) beside_[near.node].pop_back();
  for (const Index j : behind_[i]) ahead_[j].pop_back();
  for (const Ahead& j : ahead_[i]) behind_[j.node].pop_back();
  cells_[cell(nodes_[i].frame, nodes_[i].patch.position)].pop_back();
  erase_from(off_[t], at_, i);
  nodes_.pop_back(), beside_.pop_back(), ahead_.pop_back(), behind_.pop_back(), at_.pop_back();
}

bool HiddenGraph::linkable(Index v, Index w) const {
  return std::ranges::find(ahead_[v], w, &Ahead::node) != ahead_[v].end();
}

Ahead HiddenGraph::make_ahead(Index v, Index w) const {
  const Node &past = nodes_[v], &node = nodes_[w];
  const Point moved = node.patch.position - past.patch.position - past.drift;
  const double cosine = graph::dot(past.tangent, node.tangent);
  const double sine = past.tangent.x * node.tangent.y - past.tangent.y * node.tangent.x;
  Ahead result;
  result.node = w;
  result.across = graph::dot(moved, past.normal());
  result.along = graph::dot(moved, past.tangent);
  result.turn = cosine < 0 ? std::atan2(-sine, -cosine) : std::atan2(sine, cosine);
  result.flicker = node.log_contrast - past.log_contrast;
  result.sense = cosine < 0 ? -1 : 1;
  return result;
}

void HiddenGraph::set_place(Index i, double log_birth, std::uint8_t place, Point drift) {
  nodes_[i].log_birth = log_birth, nodes_[i].place = place, nodes_[i].drift = drift;
  for (Ahead& ahead : ahead_[i]) ahead = make_ahead(i, ahead.node);
}

void HiddenGraph::allow_edge(Index a, Index b) {
  if (std::ranges::find(beside_[a], b, &Beside::node) != beside_[a].end()) return;
  beside_[a].push_back({b, closeness(nodes_[a], nodes_[b]), 0});
  beside_[b].push_back({a, closeness(nodes_[b], nodes_[a]), 0});
}

void HiddenGraph::set_edge_evidence(Index a, Index b, double nats) {
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
    for (Beside& near : beside_[from])
      if (near.node == to) near.evidence = static_cast<float>(nats);
}

void HiddenGraph::allow_link(Index before, Index after) {
  if (linkable(before, after)) return;
  ahead_[before].push_back(make_ahead(before, after));
  behind_[after].push_back(before);
}

bool HiddenGraph::can_link(Index v, Index w) const {
  const Node &a = nodes_[v], &b = nodes_[w];
  if (!a.on || !b.on || b.frame != a.frame + 1 || a.next.full() || b.prev.full() || a.next.has(w))
    return false;
  // A star: at most one of both ends has partners, and these have no other.
  if (!a.next.empty() && !b.prev.empty()) return false;
  const auto single = [&](Index x, bool forward) {
    return (forward ? nodes_[x].next : nodes_[x].prev).size() == 1;
  };
  return std::ranges::all_of(a.next, [&](Index x) { return single(x, false); }) &&
         std::ranges::all_of(b.prev, [&](Index x) { return single(x, true); });
}

void HiddenGraph::link(Index v, Index w) {
  nodes_[v].next.push(w);
  nodes_[w].prev.push(v);
}
HiddenGraph::Places HiddenGraph::unlink(Index v, Index w) {
  return {nodes_[v].next.erase(w), nodes_[w].prev.erase(v)};
}
void HiddenGraph::undo_unlink(Index v, Index w, Places at) {
  nodes_[v].next.insert(at.first, w);
  nodes_[w].prev.insert(at.second, v);
}
void HiddenGraph::join(Index a, Index b) {
  nodes_[a].edges.push(b);
  nodes_[b].edges.push(a);
}
HiddenGraph::Places HiddenGraph::cut(Index a, Index b) {
  return {nodes_[a].edges.erase(b), nodes_[b].edges.erase(a)};
}
void HiddenGraph::undo_cut(Index a, Index b, Places at) {
  nodes_[a].edges.insert(at.first, b);
  nodes_[b].edges.insert(at.second, a);
}

void HiddenGraph::count_overlaps(Index i, int change) {
  if (gates_.overlap <= 0) return;
  for (const Beside& near : beside_[i])
    if (overlaps(i, near.node))
      nodes_[near.node].overlapped = static_cast<std::uint8_t>(nodes_[near.node].overlapped + change);
}

void HiddenGraph::put(Index i) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  erase_from(off_[t], at_, i);
  append_to(on_[t], at_, i);
  nodes_[i].on = true;
  count_overlaps(i, 1);
}
HiddenGraph::Places HiddenGraph::take(Index i) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  const std::size_t place = at_[i];
  erase_from(on_[t], at_, i);
  append_to(off_[t], at_, i);
  nodes_[i].on = false;
  count_overlaps(i, -1);
  return {place, 0};
}
void HiddenGraph::undo_take(Index i, Places at) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  off_[t].pop_back();
  put_back(on_[t], at_, i, at.first);
  nodes_[i].on = true;
  count_overlaps(i, 1);
}
HiddenGraph::Places HiddenGraph::off_place(Index i) const {
  return {at_[i], 0};
}
void HiddenGraph::undo_put(Index i, Places at) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  on_[t].pop_back();
  put_back(off_[t], at_, i, at.first);
  nodes_[i].on = false;
  count_overlaps(i, -1);
}

std::uint64_t HiddenGraph::hash() const {
  std::uint64_t sum = 0;
  for (Index i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (!node.on) continue;
    sum += mixed(3 * std::uint64_t{i} + 1) ^ mixed(std::bit_cast<std::uint64_t>(node.sway) + i);
    for (const Index j : node.edges)
      if (i < j) sum += mixed((std::uint64_t{i} << 32U | j) * 2 + 1);
    for (const Index j : node.next) sum += mixed(mixed(std::uint64_t{i} << 32U | j));
  }
  return sum;
}

bool HiddenGraph::operator==(const HiddenGraph& o) const {
  if (nodes_.size() != o.nodes_.size()) return false;
  for (Index i = 0; i < nodes_.size(); ++i) {
    const Node &a = nodes_[i], &b = o.nodes_[i];
    if (a.on != b.on) return false;
    if (a.on && (a.sway != b.sway || !same_set(a.edges, b.edges) || !same_set(a.next, b.next))) return false;
  }
  return true;
}

namespace {

// The patches of another sketch of the frame that overlap none of `nodes` (which they join), and its edges.
void add_others(HiddenGraph& state, const graph::AttributeGraph& other, int frame, std::vector<Index>& nodes,
                const Gates& gates) {
  std::vector<Point> places;
  for (const Index i : nodes) places.push_back(state[i].patch.position);
  const graph::detail::Near near(places, std::max(gates.overlap, 0.5));
  std::vector<Index> as;
  for (const auto& vertex : other.vertices()) {
    const Point at = vertex.patch.position;
    Index nearest = kNone;
    for (const Index k : near.around(at))
      if (state[nodes[k]].kind == kind(vertex.patch) &&
          (nearest == kNone ||
           graph::distance(places[k], at) < graph::distance(state[nearest].patch.position, at)))
        nearest = nodes[k];
    as.push_back(nearest != kNone ? nearest : state.add_candidate(frame, vertex.patch));
  }
  for (const auto& edge : other.edges()) {
    const Index a = as[other.index_of(edge.a)], b = as[other.index_of(edge.b)];
    if (a != b) state.allow_edge(a, b);
  }
  for (const Index i : as)
    if (!state[i].on) nodes.push_back(i);
  std::ranges::sort(nodes);
  const auto repeated = std::ranges::unique(nodes);
  nodes.erase(repeated.begin(), repeated.end());
}

}  // namespace

HiddenGraph hidden_graph(const graph::MotionGraph& start, std::span<const graph::SketchSequence> others,
                         const Gates& gates) {
  const auto& sketch = start.sketch;
  for (const auto& other : others)
    if (other.width != sketch.width || other.height != sketch.height ||
        other.frames.size() != sketch.frames.size())
      throw core::InputError("hidden graph: the starts are of different clips");
  HiddenGraph state(sketch.width, sketch.height, static_cast<int>(sketch.frames.size()), gates);
  std::vector<Index> before;
  for (std::size_t t = 0; t < sketch.frames.size(); ++t) {
    const auto frame = static_cast<int>(t);
    const auto& shown = sketch.frames[t];
    std::vector<Index> now;
    for (const auto& vertex : shown.vertices()) now.push_back(state.add_candidate(frame, vertex.patch));
    std::vector<Index> nodes = now;
    for (const Index i : now) state.put(i);
    for (const auto& edge : shown.edges()) {
      const Index a = now[shown.index_of(edge.a)], b = now[shown.index_of(edge.b)];
      state.allow_edge(a, b);
      if (state.can_join(a, b)) state.join(a, b);
    }
    for (const auto& link : start.links[t]) {
      const auto& past = sketch.frames[t - 1];
      const Index v = before[past.index_of(link.before)], w = now[shown.index_of(link.after)];
      state.allow_link(v, w);
      if (state.can_link(v, w)) state.link(v, w);
    }
    for (const auto& other : others) add_others(state, other.frames[t], frame, nodes, gates);
    before = std::move(now);
  }
  return state;
}

graph::MotionGraph motion_graph(const HiddenGraph& state, double fps) {
  graph::MotionGraph motion;
  motion.sketch.width = state.width(), motion.sketch.height = state.height(), motion.sketch.fps = fps;
  std::vector<std::uint32_t> id(state.size());
  std::uint32_t next_id = 0;
  for (int t = 0; t < state.frames(); ++t) {
    std::vector<Index> shown(state.on(t).begin(), state.on(t).end());
    std::ranges::sort(shown);
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    std::vector<graph::Link> links;
    for (const Index i : shown) {
      id[i] = next_id++;
      vertices.push_back({{id[i]}, {}, state[i].patch});
      for (const Index j : state[i].prev) links.push_back({{id[j]}, {id[i]}});
    }
    for (const Index i : shown)
      for (const Index j : state[i].edges)
        if (i < j) edges.push_back({{id[i]}, {id[j]}});
    std::ranges::sort(links);
    motion.sketch.frames.emplace_back(std::move(vertices), std::move(edges));
    if (t > 0) {
      const auto& frames = motion.sketch.frames;
      links = graph::supported_links(frames[frames.size() - 2], frames.back(), std::move(links));
    }
    motion.links.push_back(std::move(links));
  }
  return graph::identify(std::move(motion));
}

}  // namespace emberfold::mcmc
