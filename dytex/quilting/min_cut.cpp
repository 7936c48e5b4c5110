// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/min_cut.hpp"

#include <algorithm>
#include <limits>

namespace emberfold::dytex::detail {

namespace {

// Marks in place of a parent's arc.
constexpr std::int32_t kFree = -1, kTerminal = -2, kOrphan = -3;
constexpr std::int32_t kNever = std::numeric_limits<std::int32_t>::max();

}  // namespace

MinCut::MinCut(std::size_t nodes, std::size_t edges) : nodes_(nodes) {
  arcs_.reserve(2 * edges);
}

void MinCut::add_costs(std::int32_t i, std::int32_t on_first, std::int32_t on_second) {
  // A node on the first side is cut from the second terminal: the cost common to both sides flows at once.
  std::int32_t& room = node(i).room;
  if (room > 0)
    on_second += room;
  else
    on_first -= room;
  flow_ += std::min(on_first, on_second);
  room = on_second - on_first;
}

void MinCut::add_edge(std::int32_t a, std::int32_t b, std::int32_t cost, std::int32_t reverse_cost) {
  const auto index = static_cast<std::int32_t>(arcs_.size());
  arcs_.push_back({b, node(a).first, cost});
  arcs_.push_back({a, node(b).first, reverse_cost});
  node(a).first = index;
  node(b).first = index + 1;
}

void MinCut::wake(std::int32_t i) {
  if (node(i).waits) return;
  node(i).waits = true;
  awake_.push_back(i);
}

std::int32_t MinCut::next_awake() {
  while (!awake_.empty()) {
    const std::int32_t i = awake_.front();
    awake_.pop_front();
    node(i).waits = false;
    if (node(i).parent != kFree) return i;
  }
  return -1;
}

// Grows a tree from one of its nodes; returns the arc that leads from the first tree into the second.
std::int32_t MinCut::grow(std::int32_t i) {
  const Node own = node(i);
  for (std::int32_t a = own.first; a >= 0; a = arc(a).next) {
    if (arc(own.in_second ? a ^ 1 : a).room == 0) continue;
    Node& next = node(arc(a).head);
    if (next.parent == kFree) {
      next.in_second = own.in_second;
      next.parent = a ^ 1;
      next.time = own.time;
      next.distance = own.distance + 1;
      wake(arc(a).head);
    } else if (next.in_second != own.in_second) {
      return own.in_second ? a ^ 1 : a;
    } else if (next.time <= own.time && next.distance > own.distance) {
      next.parent = a ^ 1;  // a shorter path to the root
      next.time = own.time;
      next.distance = own.distance + 1;
    }
  }
  return -1;
}

std::int32_t MinCut::narrowest(std::int32_t i, bool second, std::int32_t least) {
  for (;;) {
    const std::int32_t a = node(i).parent;
    if (a == kTerminal) return std::min(least, second ? -node(i).room : node(i).room);
    least = std::min(least, room_up(a, second));
    i = arc(a).head;
  }
}

void MinCut::push(std::int32_t i, bool second, std::int32_t amount) {
  for (;;) {
    const std::int32_t a = node(i).parent;
    if (a == kTerminal) break;
    room_up(a ^ 1, second) += amount;
    room_up(a, second) -= amount;
    if (room_up(a, second) == 0) orphan(i, true);
    i = arc(a).head;
  }
  node(i).room += second ? amount : -amount;
  if (node(i).room == 0) orphan(i, true);
}

void MinCut::augment(std::int32_t bridge) {
  const std::int32_t from = arc(bridge ^ 1).head, to = arc(bridge).head;
  const std::int32_t amount = narrowest(to, true, narrowest(from, false, arc(bridge).room));
  arc(bridge ^ 1).room += amount;
  arc(bridge).room -= amount;
  push(from, false, amount);
  push(to, true, amount);
  flow_ += amount;
}

void MinCut::orphan(std::int32_t i, bool at_front) {
  node(i).parent = kOrphan;
  if (at_front)
    orphans_.push_front(i);
  else
    orphans_.push_back(i);
}

// Returns the length of the path to the terminal; kNever where it ends at an orphan.
std::int32_t MinCut::distance_to_root(std::int32_t i) {
  std::int32_t distance = 0;
  for (;;) {
    Node& here = node(i);
    if (here.time == time_) return distance + here.distance;
    ++distance;
    if (here.parent == kTerminal) {
      here.time = time_;
      here.distance = 1;
      return distance;
    }
    if (here.parent == kOrphan) return kNever;
    i = arc(here.parent).head;
  }
}

// Finds a new parent for an orphan in its tree, or sets it free.
void MinCut::adopt(std::int32_t i) {
  const bool second = node(i).in_second;
  std::int32_t best = kFree, least = kNever;
  for (std::int32_t a = node(i).first; a >= 0; a = arc(a).next) {
    const std::int32_t j = arc(a).head;
    if (room_up(a, second) == 0 || node(j).in_second != second || node(j).parent == kFree) continue;
    const std::int32_t distance = distance_to_root(j);
    if (distance == kNever) continue;
    if (distance < least) best = a, least = distance;
    std::int32_t left = distance;
    for (std::int32_t k = j; node(k).time != time_; k = arc(node(k).parent).head) {
      node(k).time = time_;
      node(k).distance = left--;
    }
  }
  node(i).parent = best;
  if (best != kFree) {
    node(i).time = time_;
    node(i).distance = least + 1;
    return;
  }
  for (std::int32_t a = node(i).first; a >= 0; a = arc(a).next) {
    const std::int32_t j = arc(a).head, parent = node(j).parent;
    if (node(j).in_second != second || parent == kFree) continue;
    if (room_up(a, second) > 0) wake(j);
    if (parent >= 0 && arc(parent).head == i) orphan(j, false);
  }
}

std::int64_t MinCut::solve() {
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(nodes_.size()); ++i) {
    Node& here = node(i);
    if (here.room == 0) continue;
    here.in_second = here.room < 0;
    here.parent = kTerminal;
    here.distance = 1;
    wake(i);
  }
  for (std::int32_t i = next_awake(); i >= 0;) {
    const std::int32_t bridge = grow(i);
    ++time_;
    if (bridge < 0) {
      i = next_awake();
      continue;
    }
    augment(bridge);
    while (!orphans_.empty()) {
      const std::int32_t lost = orphans_.front();
      orphans_.pop_front();
      adopt(lost);
    }
    if (node(i).parent == kFree) i = next_awake();
  }
  return flow_;
}

bool MinCut::is_second(std::int32_t i) const {
  const Node& here = nodes_[static_cast<std::size_t>(i)];
  return here.parent == kFree || here.in_second;
}

}  // namespace emberfold::dytex::detail
