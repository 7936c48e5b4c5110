// SPDX-License-Identifier: Apache-2.0
#include "sketch/lobes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace emberfold::sketch {

using graph::Point;

namespace {

// How much less than a response its explanation may be: by stronger lines, and by all.
constexpr double kOfOne = 1.4, kOfAll = 1.6;

// Where accepted lines run: each pixel near one refers to its point.
class Accepted {
 public:
  Accepted(cv::Size frame) : index_(frame, -1) {}

  void add(const Chain& chain) {
    for (const CreasePoint& p : chain.points) {
      const int x = static_cast<int>(std::lround(p.position.x)),
                y = static_cast<int>(std::lround(p.position.y));
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (x + dx >= 0 && y + dy >= 0 && x + dx < index_.cols && y + dy < index_.rows)
            index_(y + dy, x + dx) = static_cast<int>(points_.size());
      points_.push_back(&p);
    }
  }

  // The first point met on the way from p along u.
  [[nodiscard]] const CreasePoint* first_on(Point p, Point u, double reach) const {
    for (double d = 1; d <= reach; d += 1) {
      const int x = static_cast<int>(std::lround(p.x + d * u.x)),
                y = static_cast<int>(std::lround(p.y + d * u.y));
      if (x < 0 || y < 0 || x >= index_.cols || y >= index_.rows) return nullptr;
      if (index_(y, x) >= 0) return points_[static_cast<std::size_t>(index_(y, x))];
    }
    return nullptr;
  }

 private:
  cv::Mat1i index_;
  std::vector<const CreasePoint*> points_;
};

// What the line through q adds to the second derivative at p, seen at scale sigma, with its opposite sign.
double lobe(const CreasePoint& q, Point p, double sigma, const ScaleSpace& space) {
  const double s = space[static_cast<std::size_t>(q.level)].sigma, spread2 = s * s + sigma * sigma;
  const double d2 = std::pow(graph::distance(p, q.position), 2) / spread2;
  return q.contrast * s * std::pow(spread2, -1.5) * (d2 - 1) * std::exp(-0.5 * d2);
}

/// The share of a line's response that lines of the other sign explain.
double explained(const Chain& chain, const Accepted& opposite, const ScaleSpace& space) {
  constexpr double kReach = 4;  // reach in S of a line as wide as this one
  const std::size_t own = middle_level(chain.points, space);
  const double sigma = space[own].sigma, reach = kReach * 1.5 * sigma + 4;
  double seen = 0, predicted = 0;
  for (std::size_t i = 0; i < chain.points.size(); i += 2) {
    const Point p = chain.points[i].position, u = direction(chain, i), across{-u.y, u.x};
    seen += std::abs(space[own].hessian_at(p).along(across));
    for (const Point side : {across, across * -1})
      if (const CreasePoint* q = opposite.first_on(p, side, reach);
          q != nullptr && space[static_cast<std::size_t>(q->level)].channel == space[own].channel)
        predicted += std::max(0.0, lobe(*q, p, sigma, space));
  }
  return seen > 0 ? predicted / seen : 0;
}

// Lines respond to half their scale at least nearly as much as to their own (a Gaussian one 2.0 times, a box
// 0.84 times); blurred flanks with flat ground between them do not.
bool blurred_ground(const Chain& chain, const ScaleSpace& space) {
  constexpr double kLeast = 0.65;
  const std::size_t own = middle_level(chain.points, space);
  if (space[own].octave < 2) return false;
  double at_own = 0, at_half = 0;
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    const Point p = chain.points[i].position, u = direction(chain, i), across{-u.y, u.x};
    at_own += space[own].hessian_at(p).along(across);
    at_half += space[own - 2].hessian_at(p).along(across);
  }
  return at_half * at_own < 0 || std::abs(at_half) < kLeast * std::abs(at_own);
}

double mean_strength(const Chain& chain) {
  return std::accumulate(chain.points.begin(), chain.points.end(), 0.0,
                         [](double sum, const CreasePoint& p) { return sum + p.strength; }) /
         static_cast<double>(chain.points.size());
}

// What lies between two lines of the other sign was judged by the stronger of them alone if it came before
// the weaker one: each line that was accepted is judged anew by all others that were.
void drop_between(const std::vector<Chain>& chains, const std::vector<std::size_t>& order, cv::Size frame,
                  const ScaleSpace& space, const std::vector<double>& share, std::vector<bool>& dropped) {
  constexpr double kLeast = 0.2;  // of the response: less was explained by the stronger of the two
  if (std::ranges::none_of(order, [&](std::size_t c) { return !dropped[c] && share[c] >= kLeast; })) return;
  const auto accepted = [&](CreaseKind kind) {
    Accepted lines(frame);
    for (const std::size_t c : order)
      if (!dropped[c] && chains[c].kind == kind) lines.add(chains[c]);
    return lines;
  };
  Accepted ridges = accepted(CreaseKind::ridge), valleys = accepted(CreaseKind::valley);
  for (const std::size_t c : order) {
    if (dropped[c] || share[c] < kLeast) continue;
    const bool ridge = chains[c].kind == CreaseKind::ridge;
    if (explained(chains[c], ridge ? valleys : ridges, space) * kOfAll <= 1) continue;
    dropped[c] = true;
    (ridge ? ridges : valleys) = accepted(chains[c].kind);
  }
}

}  // namespace

std::vector<Chain> without_lobes(std::vector<Chain> chains, const ScaleSpace& space, cv::Size frame) {
  std::vector<double> strength;
  for (const Chain& chain : chains) strength.push_back(mean_strength(chain));
  std::vector<std::size_t> order(chains.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return strength[a] > strength[b]; });
  Accepted ridges(frame), valleys(frame);
  std::vector<bool> dropped(chains.size(), false);
  std::vector<double> share(chains.size(), 0);
  for (const std::size_t c : order) {
    if (chains[c].kind == CreaseKind::step) continue;
    const bool ridge = chains[c].kind == CreaseKind::ridge;
    share[c] = explained(chains[c], ridge ? valleys : ridges, space);
    dropped[c] = share[c] * kOfOne > 1 || blurred_ground(chains[c], space);
    if (!dropped[c]) (ridge ? ridges : valleys).add(chains[c]);
  }
  drop_between(chains, order, frame, space, share, dropped);
  std::vector<Chain> kept;
  for (std::size_t c = 0; c < chains.size(); ++c)
    if (!dropped[c]) kept.push_back(std::move(chains[c]));
  return kept;
}

}  // namespace emberfold::sketch
