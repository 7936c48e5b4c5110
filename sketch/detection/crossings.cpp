// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace emberfold::sketch {

using graph::Point;

namespace {

// A piece of the way that a line takes: from one point of a curve to the next, or between ends that met.
struct Piece {
  Point from, to;
  CreaseKind kind;
  std::size_t owner;  // the curve, or the meeting
  std::size_t point;  // on the curve
};

double side(Point a, Point b, Point p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

bool cross(const Piece& p, const Piece& q) {
  return side(p.from, p.to, q.from) * side(p.from, p.to, q.to) < 0 &&
         side(q.from, q.to, p.from) * side(q.from, q.to, p.to) < 0;
}

// crossed(i, j), i < j, for all pieces of one kind that cross and do not belong together; by a sweep in x.
template <class Crossed>
void sweep(const std::vector<Piece>& pieces, Crossed crossed) {
  const auto left = [&](std::size_t i) { return std::min(pieces[i].from.x, pieces[i].to.x); };
  const auto right = [&](std::size_t i) { return std::max(pieces[i].from.x, pieces[i].to.x); };
  std::vector<std::size_t> order(pieces.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return left(a) < left(b); });
  std::vector<std::pair<std::size_t, std::size_t>> found;
  std::vector<std::size_t> open;
  for (const std::size_t i : order) {
    std::erase_if(open, [&](std::size_t j) { return right(j) < left(i); });
    for (const std::size_t j : open)
      if (pieces[i].kind == pieces[j].kind && pieces[i].owner != pieces[j].owner &&
          cross(pieces[i], pieces[j]))
        found.push_back(std::minmax(i, j));
    open.push_back(i);
  }
  std::sort(found.begin(), found.end());
  for (const auto& [i, j] : found) crossed(i, j);
}

Point place(const CurveNetwork& network, const Contact& c) {
  return network.chains[c.chain].points[c.point].position;
}

bool has_contact_near(const CurveNetwork& network, const std::vector<Contact>& meeting, std::size_t chain,
                      Point p) {
  constexpr double kNear = 8;  // px
  return std::any_of(meeting.begin(), meeting.end(), [&](const Contact& c) {
    return c.chain == chain && graph::distance(place(network, c), p) <= kNear;
  });
}

// Curves that run through each other.
void add_crossings(CurveNetwork& network) {
  std::vector<Piece> pieces;
  for (std::size_t c = 0; c < network.chains.size(); ++c) {
    const Chain& chain = network.chains[c];
    if (chain.kind == CreaseKind::step) continue;
    for (std::size_t i = 0; i + 1 < chain.points.size(); ++i)
      pieces.push_back({chain.points[i].position, chain.points[i + 1].position, chain.kind, c, i});
  }
  sweep(pieces, [&](std::size_t i, std::size_t j) {
    const Piece &p = pieces[i], &q = pieces[j];
    const bool known =
        std::any_of(network.meetings.begin(), network.meetings.end(), [&](const auto& meeting) {
          return has_contact_near(network, meeting, p.owner, p.from) &&
                 has_contact_near(network, meeting, q.owner, p.from);
        });
    if (!known) network.meetings.push_back({{p.owner, p.point}, {q.owner, q.point}});
  });
}

// Pairs of ends that met across each other.
void merge_crossed_meetings(CurveNetwork& network) {
  std::vector<Piece> ways;
  for (std::size_t m = 0; m < network.meetings.size(); ++m) {
    const auto& meeting = network.meetings[m];
    const CreaseKind kind = network.chains[meeting.front().chain].kind;
    if (meeting.size() == 2 && kind != CreaseKind::step)
      ways.push_back({place(network, meeting[0]), place(network, meeting[1]), kind, m, 0});
  }
  sweep(ways, [&](std::size_t i, std::size_t j) {
    auto &into = network.meetings[ways[i].owner], &from = network.meetings[ways[j].owner];
    into.insert(into.end(), from.begin(), from.end());
    from.clear();
  });
  std::erase_if(network.meetings, [](const auto& meeting) { return meeting.empty(); });
}

}  // namespace

CurveNetwork merge_crossings(CurveNetwork network) {
  merge_crossed_meetings(network);
  add_crossings(network);
  return network;
}

}  // namespace emberfold::sketch
