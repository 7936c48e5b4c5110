// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/curve_tracing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/math/fast_round.hpp"
#include "core/math/robust.hpp"
#include "sketch/detection/by_strength.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

constexpr std::array<std::array<int, 2>, 8> kOctants = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

// The difference in (−π, π]; both are a few turns at most.
double turn(double from, double to) {
  double difference = to - from;
  while (difference > std::numbers::pi) difference -= 2 * std::numbers::pi;
  while (difference <= -std::numbers::pi) difference += 2 * std::numbers::pi;
  return difference;
}

// The undirected theta of a point, as the one of its two directions nearer to `along`.
double directed(double theta, double along) {
  return std::abs(turn(along, theta)) > std::numbers::pi / 2 ? theta + std::numbers::pi : theta;
}

constexpr double kDouble = 1.5;  // px: nearer points are the same line's, whichever is stronger

class Linker {
 public:
  Linker(const CreaseMap& map, const ScaleSpace& space, TracingLimits limits)
      : map_(map), space_(space), limits_(limits), spent_(map.points.size(), 0) {}

  std::vector<Chain> run() {
    std::vector<Chain> chains;
    // By strength, which is comparable between scales: a shoulder that is significant at a coarse scale only
    // must not spend the line beside it.
    for (const std::size_t seed : sort_by_strength(map_.points, &CreasePoint::strength, map_.index.size()))
      if (spent_[seed] == 0 && map_.points[seed].significance >= limits_.seed) chains.push_back(grow(seed));
    return chains;
  }

 private:
  Chain grow(std::size_t seed) {
    spent_[seed] = 1;
    const CreasePoint& start = map_.points[seed];
    spend_beside(start);
    Chain chain{map_.kind, {}, false};
    const double first = stronger_way(start);
    std::vector<CreasePoint> ahead = follow(seed, first), behind = follow(seed, first + std::numbers::pi);
    for (auto p = behind.rbegin(); p != behind.rend(); ++p) {
      p->theta -= std::numbers::pi;
      chain.points.push_back(*p);
    }
    chain.points.push_back(start);
    chain.points.back().theta = first;
    chain.points.insert(chain.points.end(), ahead.begin(), ahead.end());
    std::size_t middle = behind.size();
    if (first != start.theta) {  // steps keep their brighter side to the right
      std::reverse(chain.points.begin(), chain.points.end());
      for (CreasePoint& p : chain.points) p.theta -= std::numbers::pi;
      middle = ahead.size();
    }
    for (CreasePoint& p : chain.points) p.theta = std::remainder(p.theta, 2 * std::numbers::pi);
    const std::size_t n = chain.points.size();
    chain.closed =
        n >= 8 && graph::distance(chain.points.front().position, chain.points.back().position) < 2.5 &&
        std::abs(turn(chain.points.back().theta, chain.points.front().theta)) < std::numbers::pi / 3;
    if (chain.closed)
      std::rotate(chain.points.begin(), chain.points.begin() + static_cast<std::ptrdiff_t>(middle),
                  chain.points.end());
    return chain;
  }

  // The one of the two directions in which more of the crease shows: where a ring begins and which way round
  // it goes then does not depend on how the frame is turned or mirrored.
  [[nodiscard]] double stronger_way(const CreasePoint& p) const {
    const ScaleLevel& level = space_[static_cast<std::size_t>(p.level)];
    const Point along{std::cos(p.theta), std::sin(p.theta)}, across{-along.y, along.x};
    const auto shows = [&](double t) {
      const Point q = p.position + along * t;
      if (map_.kind != CreaseKind::step) return (map_.kind == CreaseKind::ridge ? 1 : -1) * level.value_at(q);
      return std::abs(level.value_at(q + across * level.sigma) - level.value_at(q - across * level.sigma));
    };
    return shows(2) >= shows(-2) ? p.theta : p.theta + std::numbers::pi;
  }

  std::vector<CreasePoint> follow(std::size_t from, double theta) {
    std::vector<CreasePoint> found;
    double heading = theta;  // smoothed over some points: a curve may bend, but not break off sideways
    for (std::optional<std::size_t> next; (next = step(map_.points[from].position, theta, heading));
         from = *next) {
      CreasePoint point = map_.points[*next];
      theta = point.theta = directed(point.theta, theta);
      heading += 0.3 * turn(heading, theta);
      spent_[*next] = 1;
      spend_beside(point);
      found.push_back(point);
    }
    return found;
  }

  // The best of the three neighbours ahead, or of the pixels one further where those are empty.
  std::optional<std::size_t> step(Point position, double theta, double heading) const {
    const int octant = core::fast_round(theta / (std::numbers::pi / 4));
    const int x = core::fast_round(position.x), y = core::fast_round(position.y);
    std::optional<std::size_t> best;
    for (int reach = 1; reach <= 2 && !best; ++reach) {
      double least = 1e9;
      for (int side = -1; side <= 1; ++side) {
        const auto& d = kOctants[static_cast<std::size_t>(((octant + side) % 8 + 8) % 8)];
        const auto candidate = at(x + reach * d[0], y + reach * d[1]);
        if (!candidate) continue;
        const CreasePoint& p = map_.points[*candidate];
        const double bend = std::abs(turn(theta, directed(p.theta, theta)));
        const Point v = p.position - position;
        const double way = std::sqrt(graph::dot(v, v));
        if (bend > std::numbers::pi / 4 || way < 0.2) continue;
        if (way > 0.7 && std::abs(turn(heading, std::atan2(v.y, v.x))) > std::numbers::pi / 3.5) continue;
        if (way + bend < least) {
          least = way + bend;
          best = candidate;
        }
      }
    }
    return best;
  }

  std::optional<std::size_t> at(int x, int y) const {
    if (x < 0 || y < 0 || x >= map_.index.cols || y >= map_.index.rows) return std::nullopt;
    const int i = map_.index(y, x);
    if (i < 0 || spent_[static_cast<std::size_t>(i)] != 0) return std::nullopt;
    return static_cast<std::size_t>(i);
  }

  // Double responses: parallel points to the sides, nearer than two lines of this size can be resolved.
  void spend_beside(const CreasePoint& p) {
    const int x = core::fast_round(p.position.x), y = core::fast_round(p.position.y);
    const Point normal{-std::sin(p.theta), std::cos(p.theta)};
    const double reach = std::max(kDouble, space_[static_cast<std::size_t>(p.level)].sigma);
    const int box = static_cast<int>(std::ceil(reach));
    const Point way{normal.y, -normal.x};
    // Points lie within 0.6 px of their pixel's middle, both ways: of each row the pixels are looked at whose
    // points may lie near enough along the crease.
    constexpr double kAlong = 0.8, kAway = 0.86;
    const bool narrow = std::abs(way.x) > 1e-3;
    const double half = narrow ? (kAlong + kAway) / std::abs(way.x) + 1 : 1e6;
    const int left = std::max(x - box, 0), right = std::min(x + box, map_.index.cols - 1);
    for (int row = std::max(y - box, 0); row <= std::min(y + box, map_.index.rows - 1); ++row) {
      const double middle = p.position.x - (narrow ? (row - p.position.y) * way.y / way.x : 0);
      const int first = std::max(left, static_cast<int>(middle - half)),
                last = std::min(right, static_cast<int>(middle + half));
      const int* entries = map_.index[row];
      for (int column = first; column <= last; ++column) {
        if (entries[column] < 0) continue;
        const auto beside = static_cast<std::size_t>(entries[column]);
        if (spent_[beside] != 0) continue;
        const CreasePoint& q = map_.points[beside];
        const Point v = q.position - p.position;
        const double across = std::abs(graph::dot(v, normal)), along = std::abs(graph::dot(v, way));
        if (across <= (q.strength < p.strength ? reach : kDouble) && along < kAlong &&
            graph::orientation_difference(p.theta, q.theta) < std::numbers::pi / 5)
          spent_[beside] = 1;
      }
    }
  }

  const CreaseMap& map_;
  const ScaleSpace& space_;
  TracingLimits limits_;
  std::vector<char> spent_;
};

}  // namespace

std::size_t median_level(std::span<const CreasePoint> points, const ScaleSpace& space) {
  const auto channel_of = [&](int level) { return space[static_cast<std::size_t>(level)].channel; };
  std::vector<std::size_t> count(static_cast<std::size_t>(space.back().channel) + 1);
  std::vector<int> levels;
  levels.reserve(points.size());
  for (const CreasePoint& p : points) {
    levels.push_back(p.level);
    ++count[static_cast<std::size_t>(channel_of(p.level))];
  }
  const auto most = std::max_element(count.begin(), count.end()) - count.begin();
  std::erase_if(levels, [&](int level) { return channel_of(level) != most; });
  return static_cast<std::size_t>(core::median(std::move(levels)));
}

double evidence(const Chain& chain) {
  double nats = 0;
  for (const CreasePoint& p : chain.points) nats += p.evidence;
  return nats;
}

std::vector<Chain> trace_curves(const CreaseMap& map, const ScaleSpace& space, TracingLimits limits) {
  return Linker(map, space, limits).run();
}

std::vector<double> arc_lengths(const Chain& chain) {
  std::vector<double> s(chain.points.size(), 0.0);
  for (std::size_t i = 1; i < s.size(); ++i) {
    const Point v = chain.points[i].position - chain.points[i - 1].position;
    s[i] = s[i - 1] + std::sqrt(graph::dot(v, v));
  }
  return s;
}

Point tangent(const Chain& chain, std::size_t at, std::size_t reach) {
  const std::size_t first = at > reach ? at - reach : 0, last = std::min(at + reach, chain.points.size() - 1);
  const Point v = chain.points[last].position - chain.points[first].position;
  const double length = std::sqrt(graph::dot(v, v));
  if (length < 1e-9) return {std::cos(chain.points[at].theta), std::sin(chain.points[at].theta)};
  return v * (1 / length);
}

std::vector<CurveEnd> free_ends(const std::vector<Chain>& chains) {
  constexpr std::size_t kReach = 5;  // points over which the direction of an end is taken
  std::vector<CurveEnd> ends;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (chains[c].closed) continue;
    for (const bool back : {false, true}) {
      const std::size_t at = back ? chains[c].points.size() - 1 : 0;
      const Point along = tangent(chains[c], at, kReach);
      ends.push_back({c, back, chains[c].points[at].position, back ? along : along * -1});
    }
  }
  return ends;
}

std::vector<Chain> remove_hooks(std::vector<Chain> chains) {
  constexpr std::size_t kTail = 6, kBody = 14;  // points
  constexpr double kAside = std::numbers::pi / 5;
  for (Chain& chain : chains) {
    if (chain.closed || chain.points.size() < kBody) continue;
    const auto hooked = [&](std::size_t end, std::size_t from, std::size_t to) {
      const Point body = chain.points[to].position - chain.points[from].position;
      return graph::orientation_difference(chain.points[end].theta, std::atan2(body.y, body.x)) > kAside;
    };
    std::size_t first = 0, last = chain.points.size() - 1;
    while (first < kTail && hooked(first, kTail, kBody - 1)) ++first;
    const std::size_t n = chain.points.size();
    while (last > n - 1 - kTail && hooked(last, n - kBody, n - 1 - kTail)) --last;
    chain.points = {chain.points.begin() + static_cast<std::ptrdiff_t>(first),
                    chain.points.begin() + static_cast<std::ptrdiff_t>(last) + 1};
  }
  return chains;
}

}  // namespace emberfold::sketch
