// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/junctions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/math/robust.hpp"
#include "sketch/detection/creaseness.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

struct Meeting {
  double cost;
  std::size_t end;
  Contact target;
};

std::size_t end_point(const Chain& chain, bool back) {
  return back ? chain.points.size() - 1 : 0;
}

// Points of all chains by cells of 8 px.
class Grid {
 public:
  explicit Grid(const std::vector<Chain>& chains) {
    for (const Chain& chain : chains)
      for (const CreasePoint& p : chain.points) {
        columns_ = std::max(columns_, column(p.position.x) + 1);
        rows_ = std::max(rows_, column(p.position.y) + 1);
      }
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t c = 0; c < chains.size(); ++c)
      for (std::size_t i = 0; i < chains[c].points.size(); ++i) {
        const Point p = chains[c].points[i].position;
        cells_[cell(column(p.x), column(p.y))].push_back({c, i});
      }
  }

  template <class Visit>
  void near(Point p, double radius, Visit visit) const {
    const int x0 = std::max(0, column(p.x - radius)), x1 = std::min(columns_ - 1, column(p.x + radius));
    const int y0 = std::max(0, column(p.y - radius)), y1 = std::min(rows_ - 1, column(p.y + radius));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        for (const Contact& c : cells_[cell(x, y)]) visit(c);
  }

 private:
  [[nodiscard]] std::size_t cell(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  static int column(double v) { return static_cast<int>(std::floor(std::max(v, 0.0) / 8)); }
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<Contact>> cells_;
};

// Largest distance of an end from a curve that it may meet, px. A line is lost within about 3σ of a stronger
// one, and its last points may have been a hook.
double reach_of(double sigma) {
  return 3 * sigma + 8;
}

// Signed strength of a crease at a place: a ridge's level, a valley's negated, a step's right side minus its
// left.
double showing(const ScaleLevel& level, CreaseKind kind, Point p, Point across, double reach) {
  if (kind == CreaseKind::ridge) return level.value_at(p);
  if (kind == CreaseKind::valley) return -level.value_at(p);
  return level.value_at(p + across * reach) - level.value_at(p - across * reach);
}

// Over the last points before an end: half way between the ground beside the curve and the curve itself, and
// the ground.
std::pair<double, double> half_showing(const Chain& chain, bool back, const ScaleLevel& level, double sigma) {
  const std::size_t n = chain.points.size(), reach = std::min<std::size_t>(n, 10);
  std::vector<double> halves, grounds;
  for (std::size_t i = std::min<std::size_t>(2, n / 2); i < reach; ++i) {
    const std::size_t at = back ? n - 1 - i : i;
    const Point p = chain.points[at].position, u = tangent(chain, at), across{-u.y, u.x};
    const double here = showing(level, chain.kind, p, across, sigma);
    const double aside = chain.kind == CreaseKind::step
                             ? 0
                             : 0.5 * (showing(level, chain.kind, p + across * (3 * sigma), across, 0) +
                                      showing(level, chain.kind, p - across * (3 * sigma), across, 0));
    halves.push_back(0.5 * (here + aside));
    grounds.push_back(aside);
  }
  return {core::median(std::move(halves)), core::median(std::move(grounds))};
}

struct Bridge {
  double needed;  // how much must show
  double ground;  // shows beside the curve
  double sigma;   // px
  double slope;   // levels per px that is no noise
};

bool bridged(const ScaleLevel& level, CreaseKind kind, Point from, Point to, Point outward,
             const Bridge& bridge) {
  // A line with less contrast, but some, continues if the level lines turn about it throughout. Over a long
  // way they must turn for half of it: shading shows as a line does, but has no crest.
  constexpr double kLeastShare = 0.6, kTurning = 0.35;
  constexpr double kLong = 8, kMostFlat = 0.5;  // px, share of the way
  const double length = graph::distance(from, to);
  if (length < 1.5) return true;
  // A step keeps its side: it is sampled across the direction in which the end runs out.
  const Point across{-outward.y, outward.x};
  const double least = bridge.ground + kLeastShare * (bridge.needed - bridge.ground);
  const double sign = kind == CreaseKind::valley ? -1 : 1;
  int flat = 0;
  const int steps = static_cast<int>(std::ceil(length));
  for (int i = 1; i < steps; ++i) {
    const Point p = from + (to - from) * (1.0 * i / steps);
    const double shows = showing(level, kind, p, across, bridge.sigma);
    if (shows >= bridge.needed) {
      if (length > kLong && kind != CreaseKind::step && sign * creaseness(level, p, bridge.slope) < kTurning)
        ++flat;
      continue;
    }
    if (kind == CreaseKind::step || shows < least || sign * creaseness(level, p, bridge.slope) < kTurning)
      return false;
  }
  return flat <= kMostFlat * steps;
}

std::size_t level_near(const Chain& chain, const ScaleSpace& space, bool back) {
  const std::span points(chain.points);
  const std::size_t reach = std::min<std::size_t>(points.size(), 10);
  return median_level(back ? points.last(reach) : points.first(reach), space);
}

// Points that the end points at and reaches, the nearest one of every curve within reach.
std::vector<Meeting> candidates(const std::vector<Chain>& chains, const Grid& grid, const ScaleSpace& space,
                                const std::vector<CurveEnd>& ends, std::size_t e) {
  const CurveEnd& end = ends[e];
  const Chain& own = chains[end.chain];
  const std::size_t own_end = end_point(own, end.back);
  const std::size_t own_level = level_near(own, space, end.back);
  const ScaleLevel& level = space[own_level];
  const ScaleLevel& fine = finest_level(space, own_level);
  // half_showing looks along the chain, bridged out of the end: at the front these are opposite, which turns
  // a step's sides.
  const double side = own.kind == CreaseKind::step && !end.back ? -1 : 1;
  const auto [needed, ground] = half_showing(own, end.back, fine, level.sigma);
  const Bridge bridge{needed, ground, level.sigma,
                      std::max(0.2 * std::abs(needed - ground) / level.sigma, 0.1)};
  const double farthest = reach_of(space.back().sigma);
  const int gap = own.gap[end.back ? 1 : 0];
  const auto across_gap = [&](const Chain& other) {
    return gap > 0 && (other.gap[0] == gap || other.gap[1] == gap) && &other != &own;
  };
  std::vector<Meeting> found;
  grid.near(end.position, farthest, [&](const Contact& c) {
    const Chain& other = chains[c.chain];
    if (other.kind != own.kind || across_gap(other)) return;
    const CreasePoint& q = other.points[c.point];
    const Point way = q.position - end.position;
    const double length = std::sqrt(graph::dot(way, way));
    const double reach = reach_of(std::max(level.sigma, space[static_cast<std::size_t>(q.level)].sigma));
    if (length > reach) return;
    // On the curve itself only what lies a real detour away: the other end of a ring, not the next point.
    if (c.chain == end.chain) {
      const std::size_t apart = c.point > own_end ? c.point - own_end : own_end - c.point;
      if (static_cast<double>(apart) < 4 * reach) return;
    }
    const double turn =
        length > 0.5 ? std::acos(std::clamp(graph::dot(way, end.outward) / length, -1.0, 1.0)) : 0.0;
    if (turn > (length > 5 ? std::numbers::pi / 4 : std::numbers::pi / 2)) return;
    found.push_back({length * (1 + turn * turn), e, c});
  });
  std::stable_sort(found.begin(), found.end(), [](const Meeting& a, const Meeting& b) {
    return std::tie(a.target.chain, a.cost, a.target.point) <
           std::tie(b.target.chain, b.cost, b.target.point);
  });
  found.erase(
      std::unique(found.begin(), found.end(),
                  [](const Meeting& a, const Meeting& b) { return a.target.chain == b.target.chain; }),
      found.end());
  std::erase_if(found, [&](const Meeting& m) {
    const Point to = chains[m.target.chain].points[m.target.point].position;
    return !bridged(fine, own.kind, end.position, to, end.outward * side, bridge);
  });
  return found;
}

// A contact within 4 px of a curve's free end is with the end itself.
Contact snapped(const std::vector<Chain>& chains, Contact contact) {
  const Chain& chain = chains[contact.chain];
  if (chain.closed) return contact;
  const std::size_t last = chain.points.size() - 1;
  if (contact.point <= 4 && contact.point <= last - contact.point) return {contact.chain, 0};
  if (last - contact.point <= 4) return {contact.chain, last};
  return contact;
}

}  // namespace

CurveNetwork join_free_ends(std::vector<Chain> chains, const ScaleSpace& space) {
  CurveNetwork network;
  const std::vector<CurveEnd> ends = free_ends(chains);
  const Grid grid(chains);
  std::vector<Meeting> all;
  for (std::size_t e = 0; e < ends.size(); ++e) {
    const auto found = candidates(chains, grid, space, ends, e);
    all.insert(all.end(), found.begin(), found.end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Meeting& a, const Meeting& b) { return a.cost < b.cost; });

  std::vector<std::optional<std::size_t>> meeting_of(ends.size());  // of an end that has met something
  std::vector<std::size_t> first_end(chains.size(), ends.size());
  for (std::size_t e = ends.size(); e-- > 0;) first_end[ends[e].chain] = e;
  const auto end_index = [&](Contact c) -> std::optional<std::size_t> {
    const std::size_t first = first_end[c.chain];
    if (first == ends.size()) return std::nullopt;
    if (c.point == 0) return first;
    if (c.point == end_point(chains[c.chain], true)) return first + 1;
    return std::nullopt;
  };
  for (const Meeting& m : all) {
    if (meeting_of[m.end]) continue;
    const Contact self{ends[m.end].chain, end_point(chains[ends[m.end].chain], ends[m.end].back)};
    const Contact target = snapped(chains, m.target);
    const auto other_end = end_index(target);
    if (other_end && *other_end == m.end) continue;
    if (other_end && meeting_of[*other_end]) {
      network.meetings[*meeting_of[*other_end]].push_back(self);
      meeting_of[m.end] = meeting_of[*other_end];
      continue;
    }
    meeting_of[m.end] = network.meetings.size();
    if (other_end) meeting_of[*other_end] = network.meetings.size();
    network.meetings.push_back({self, target});
  }
  network.chains = std::move(chains);
  return network;
}

namespace {

// The number of the connected part that each curve belongs to.
std::vector<std::size_t> parts(const CurveNetwork& network) {
  std::vector<std::size_t> part(network.chains.size());
  std::iota(part.begin(), part.end(), std::size_t{0});
  const auto root = [&](std::size_t c) {
    while (part[c] != c) c = part[c] = part[part[c]];
    return c;
  };
  for (const auto& meeting : network.meetings)
    for (const Contact& c : meeting) part[root(c.chain)] = root(meeting.front().chain);
  for (std::size_t c = 0; c < part.size(); ++c) part[c] = root(c);
  return part;
}

CurveNetwork without_chains(CurveNetwork network, const std::vector<bool>& dropped) {
  const std::size_t n = network.chains.size();
  std::vector<std::size_t> renumbered(n, n);
  CurveNetwork kept;
  for (std::size_t c = 0; c < n; ++c) {
    if (dropped[c]) continue;
    renumbered[c] = kept.chains.size();
    kept.chains.push_back(std::move(network.chains[c]));
  }
  for (const auto& meeting : network.meetings) {
    std::vector<Contact> contacts;
    for (const Contact& c : meeting)
      if (renumbered[c.chain] < n) contacts.push_back({renumbered[c.chain], c.point});
    if (contacts.size() >= 2) kept.meetings.push_back(std::move(contacts));
  }
  return kept;
}

}  // namespace

CurveNetwork prune_short_curves(CurveNetwork network, const std::function<double(const Chain&)>& least) {
  for (bool changed = true; changed;) {
    const std::size_t n = network.chains.size();
    std::vector<int> attached_ends(n, 0);
    for (const auto& meeting : network.meetings)
      for (const Contact& c : meeting)
        if (c.point == 0 || c.point + 1 == network.chains[c.chain].points.size()) ++attached_ends[c.chain];
    const std::vector<std::size_t> part = parts(network);
    std::vector<double> length(n), part_length(n, 0.0);
    for (std::size_t c = 0; c < n; ++c)
      part_length[part[c]] += length[c] = arc_lengths(network.chains[c]).back() / least(network.chains[c]);
    std::vector<bool> dropped(n);
    for (std::size_t c = 0; c < n; ++c)
      dropped[c] = part_length[part[c]] < 1 || (attached_ends[c] == 1 && length[c] < 1);
    changed = std::find(dropped.begin(), dropped.end(), true) != dropped.end();
    if (changed) network = without_chains(std::move(network), dropped);
  }
  return network;
}

}  // namespace emberfold::sketch
