// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/hidden_graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace emberfold::mcmc {

namespace {

using graph::Point;

// Class of two patches of a frame, by distance and by whether both lie in line with less than 30° of turn.
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
// Puts i back at the place from which erase_from took it.
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

double turn_between(const Node& a, const Node& b) {
  const double cosine = graph::dot(a.tangent, b.tangent);
  const double sine = a.tangent.x * b.tangent.y - a.tangent.y * b.tangent.x;
  return cosine < 0 ? std::atan2(-sine, -cosine) : std::atan2(sine, cosine);
}

Kind kind(const graph::Patch& patch) {
  if (graph::on_step(patch)) return Kind::step;
  return patch.contrast < 0 ? Kind::dark : Kind::bright;
}

HiddenGraph::HiddenGraph(int width, int height, int frames, const Gates& gates)
    : width_(width), height_(height), gates_(gates) {
  active_.resize(static_cast<std::size_t>(frames));
  inactive_ = active_;
  cell_ = std::max({gates.edge, gates.link, 4.0});
  columns_ = static_cast<int>(width / cell_) + 1, rows_ = static_cast<int>(height / cell_) + 1;
  cells_.resize(active_.size() * static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
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
  flags_.push_back(0);
  neighbours_.emplace_back(), hosts_.emplace_back(), guests_.emplace_back(), candidates_after_.emplace_back(),
      candidates_before_.emplace_back(), offsets_.emplace_back();
  at_.push_back(0);
  const auto t = static_cast<std::size_t>(frame);
  const auto within = [&](Index j, double gate) {
    const Point apart = nodes_[j].patch.position - p;
    return graph::dot(apart, apart) <= gate * gate;
  };
  visit_near(frame, p, [&](Index j) {
    if (!within(j, gates_.edge)) return;
    add_neighbours(i, j);
    if (nodes_[j].active && overlaps(i, j)) ++nodes_[i].overlapped;
  });
  const auto linkable = [&](Index j) { return nodes_[j].kind == nodes_[i].kind && within(j, gates_.link); };
  if (t > 0)
    visit_near(frame - 1, p, [&](Index j) {
      if (linkable(j)) add_link_candidate(j, i);
    });
  if (t + 1 < active_.size())
    visit_near(frame + 1, p, [&](Index j) {
      if (linkable(j)) add_link_candidate(i, j);
    });
  cells_[cell(frame, p)].push_back(i);
  append_to(inactive_[t], at_, i);
  return i;
}

void HiddenGraph::drop_newest_candidate() {
  const auto i = static_cast<Index>(nodes_.size() - 1);
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  // The newest candidate is the last one in every list.
  for (const NeighbourCandidate& near : neighbours_[i]) neighbours_[near.node].pop_back();
  for (const Index j : hosts_[i]) guests_[j].pop_back();
  for (const Index j : guests_[i]) hosts_[j].pop_back();
  for (const Index j : candidates_before_[i]) candidates_after_[j].pop_back(), offsets_[j].pop_back();
  for (const Index j : candidates_after_[i]) candidates_before_[j].pop_back();
  cells_[cell(nodes_[i].frame, nodes_[i].patch.position)].pop_back();
  erase_from(inactive_[t], at_, i);
  nodes_.pop_back(), flags_.pop_back(), at_.pop_back();
  neighbours_.pop_back(), hosts_.pop_back(), guests_.pop_back(), candidates_after_.pop_back(),
      candidates_before_.pop_back(), offsets_.pop_back();
}

void HiddenGraph::add_neighbours(Index a, Index b) {
  neighbours_[a].push_back({b, closeness(nodes_[a], nodes_[b]), precedes(b, a), false, 0});
  neighbours_[b].push_back({a, closeness(nodes_[b], nodes_[a]), precedes(a, b), false, 0});
  if (!can_merge(a, neighbours_[a].back())) return;
  const Index host = precedes(a, b) ? a : b, guest = host == a ? b : a;
  hosts_[guest].push_back(host), guests_[host].push_back(guest);
}
void HiddenGraph::add_link_candidate(Index v, Index w) {
  candidates_after_[v].push_back(w);
  offsets_[v].push_back(make_offset(v, w));
  candidates_before_[w].push_back(v);
}

bool HiddenGraph::linkable(Index v, Index w) const {
  return std::ranges::find(candidates_after_[v], w) != candidates_after_[v].end();
}

TransitionOffset HiddenGraph::make_offset(Index v, Index w) const {
  const Node &past = nodes_[v], &node = nodes_[w];
  const Point moved = node.patch.position - past.patch.position - past.drift;
  TransitionOffset result;
  result.across = graph::dot(moved, past.normal());
  result.along = graph::dot(moved, past.tangent);
  result.turn = turn_between(past, node);
  result.flicker = node.log_contrast - past.log_contrast;
  result.sense = graph::dot(past.tangent, node.tangent) < 0 ? -1 : 1;
  return result;
}

void HiddenGraph::set_map_values(Index i, double log_birth, std::uint8_t place, Point drift) {
  nodes_[i].log_birth = log_birth, nodes_[i].place = place, nodes_[i].drift = drift;
  for (std::size_t k = 0; k < candidates_after_[i].size(); ++k)
    offsets_[i][k] = make_offset(i, candidates_after_[i][k]);
}

void HiddenGraph::allow_edge(Index a, Index b) {
  if (std::ranges::find(neighbours_[a], b, &NeighbourCandidate::node) != neighbours_[a].end()) return;
  add_neighbours(a, b);
}

void HiddenGraph::set_edge_evidence(Index a, Index b, double nats) {
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
    for (NeighbourCandidate& near : neighbours_[from])
      if (near.node == to) near.evidence = static_cast<float>(nats);
}

void HiddenGraph::allow_link(Index before, Index after) {
  if (linkable(before, after)) return;
  add_link_candidate(before, after);
}

void HiddenGraph::allow_together(Index a, Index b) {
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
    for (NeighbourCandidate& near : neighbours_[from])
      if (near.node == to) near.together = true;
}

bool HiddenGraph::can_link(Index v, Index w) const {
  // A star: at most one of both ends has partners, and these have no other.
  if (!is_active(v) || !is_active(w) || (has_future(v) && has_past(w))) return false;
  const Node &a = nodes_[v], &b = nodes_[w];
  if (b.frame != a.frame + 1 || a.next.full() || b.prev.full() || a.next.has(w)) return false;
  return std::ranges::all_of(a.next, [&](Index x) { return nodes_[x].prev.size() == 1; }) &&
         std::ranges::all_of(b.prev, [&](Index x) { return nodes_[x].next.size() == 1; });
}

void HiddenGraph::flag(Index i, Flag which, bool holds) {
  flags_[i] = static_cast<std::uint8_t>(holds ? flags_[i] | which : flags_[i] & ~which);
}
// Updates the flags after a link between them was added or removed.
void HiddenGraph::flag_links(Index v, Index w) {
  const auto& next = nodes_[v].next;
  const auto& prev = nodes_[w].prev;
  flag(w, kPast, !prev.empty());
  flag(v, kFuture, !next.empty());
  flag(v, kContinues, next.size() == 1 && is_parent(v, next[0]));
  for (const Index x : prev)
    if (x != v) flag(x, kContinues, nodes_[x].next.size() == 1 && is_parent(x, w));
}
void HiddenGraph::flag_edges(Index a, Index b) {
  flag(a, kCrowded, nodes_[a].edges.full());
  flag(b, kCrowded, nodes_[b].edges.full());
}

void HiddenGraph::link(Index v, Index w) {
  nodes_[v].next.push(w);
  nodes_[w].prev.push(v);
  flag_links(v, w);
}
HiddenGraph::Places HiddenGraph::unlink(Index v, Index w) {
  const Places at{nodes_[v].next.erase(w), nodes_[w].prev.erase(v)};
  flag_links(v, w);
  return at;
}
void HiddenGraph::undo_unlink(Index v, Index w, Places at) {
  nodes_[v].next.insert(at.first, w);
  nodes_[w].prev.insert(at.second, v);
  flag_links(v, w);
}
void HiddenGraph::add_edge(Index a, Index b) {
  nodes_[a].edges.push(b);
  nodes_[b].edges.push(a);
  flag_edges(a, b);
}
HiddenGraph::Places HiddenGraph::remove_edge(Index a, Index b) {
  const Places at{nodes_[a].edges.erase(b), nodes_[b].edges.erase(a)};
  flag_edges(a, b);
  return at;
}
void HiddenGraph::undo_remove_edge(Index a, Index b, Places at) {
  nodes_[a].edges.insert(at.first, b);
  nodes_[b].edges.insert(at.second, a);
  flag_edges(a, b);
}

void HiddenGraph::count_overlaps(Index i, int change) {
  if (gates_.overlap <= 0) return;
  for (const NeighbourCandidate& near : neighbours_[i])
    if (!near.together && overlaps(i, near.node))
      nodes_[near.node].overlapped = static_cast<std::uint8_t>(nodes_[near.node].overlapped + change);
}

void HiddenGraph::set_active(Index i, bool active) {
  nodes_[i].active = active;
  flag(i, kActive, active);
  count_overlaps(i, active ? 1 : -1);
}

void HiddenGraph::activate(Index i) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  erase_from(inactive_[t], at_, i);
  append_to(active_[t], at_, i);
  set_active(i, true);
}
HiddenGraph::Places HiddenGraph::deactivate(Index i) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  const std::size_t place = at_[i];
  erase_from(active_[t], at_, i);
  append_to(inactive_[t], at_, i);
  set_active(i, false);
  return {place, 0};
}
void HiddenGraph::undo_deactivate(Index i, Places at) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  inactive_[t].pop_back();
  put_back(active_[t], at_, i, at.first);
  set_active(i, true);
}
HiddenGraph::Places HiddenGraph::inactive_place(Index i) const {
  return {at_[i], 0};
}
void HiddenGraph::undo_activate(Index i, Places at) {
  const auto t = static_cast<std::size_t>(nodes_[i].frame);
  active_[t].pop_back();
  put_back(inactive_[t], at_, i, at.first);
  set_active(i, false);
}

std::uint64_t HiddenGraph::hash() const {
  std::uint64_t sum = 0;
  for (Index i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (!node.active) continue;
    sum += mixed(3 * std::uint64_t{i} + 1) ^ mixed(std::bit_cast<std::uint64_t>(node.displacement) + i);
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
    if (a.active != b.active) return false;
    if (a.active &&
        (a.displacement != b.displacement || !same_set(a.edges, b.edges) || !same_set(a.next, b.next)))
      return false;
  }
  return true;
}

}  // namespace emberfold::mcmc
