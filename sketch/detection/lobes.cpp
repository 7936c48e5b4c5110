// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/lobes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/math/bilinear.hpp"
#include "core/math/fast_round.hpp"
#include "core/math/robust.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// Factors by which a response may exceed its explanation, by one stronger line and by all.
constexpr double kOfOne = 1.4, kOfAll = 1.6;

struct Box {
  int left, top, right, bottom;
  [[nodiscard]] bool meets(const Box& o) const {
    return left <= o.right && o.left <= right && top <= o.bottom && o.top <= bottom;
  }
};

// The pixels next to a point and its own.
Box neighbour_box(const CreasePoint& p) {
  const int x = core::fast_round(p.position.x), y = core::fast_round(p.position.y);
  return {x - 1, y - 1, x + 1, y + 1};
}

// Map of the accepted lines: each pixel near one refers to its nearest point, in whatever order lines come.
class Accepted {
 public:
  explicit Accepted(cv::Size frame) : index_(make_empty_index(frame)) {}

  void add(const Chain& chain) {
    Line line{&chain, static_cast<int>(points_.size()), neighbour_box(chain.points.front())};
    for (const CreasePoint& p : chain.points) {
      const Box box = neighbour_box(p);
      line.box = {std::min(line.box.left, box.left), std::min(line.box.top, box.top),
                  std::max(line.box.right, box.right), std::max(line.box.bottom, box.bottom)};
      points_.push_back(&p);
      claim(box, static_cast<int>(points_.size()) - 1);
    }
    lines_.push_back(line);
  }

  // As if it had not been added: what lies below it shows again.
  void remove(const Chain& chain) {
    const auto found = std::ranges::find(lines_, &chain, &Line::chain);
    const Line line = *found;
    lines_.erase(found);
    const int end = line.first + static_cast<int>(chain.points.size());
    for (const CreasePoint& p : chain.points)
      visit(neighbour_box(p), [&](int& entry, Point) {
        if (entry >= line.first && entry < end) entry = -1;
      });
    for (const Line& other : lines_)
      if (other.box.meets(line.box)) show(other, line.box);
  }

  // The first point met on the way from p along u.
  [[nodiscard]] const CreasePoint* first_on(Point p, Point u, double reach) const {
    const int* const first = index_[0];
    const auto columns = static_cast<unsigned>(index_.cols), rows = static_cast<unsigned>(index_.rows);
    for (double d = 1; d <= reach; d += 1) {
      const auto x = static_cast<unsigned>(core::fast_round(p.x + d * u.x)),
                 y = static_cast<unsigned>(core::fast_round(p.y + d * u.y));
      if (x >= columns || y >= rows) return nullptr;  // below 0 too
      if (const int entry = first[std::size_t{y} * columns + x]; entry >= 0)
        return points_[static_cast<std::size_t>(entry)];
    }
    return nullptr;
  }

 private:
  struct Line {
    const Chain* chain;
    int first;  // of its points
    Box box;
  };

  void show(const Line& line, const Box& where) {
    int number = line.first;
    for (const CreasePoint& p : line.chain->points) {
      if (const Box box = neighbour_box(p); box.meets(where)) claim(box, number);
      ++number;
    }
  }

  // The stronger of two equally near points takes the pixel.
  void claim(const Box& box, int number) {
    constexpr double kSure = 1e-9;  // of a square: far more than rounding makes
    const CreasePoint& p = *points_[static_cast<std::size_t>(number)];
    visit(box, [&](int& entry, Point pixel) {
      if (entry < 0) {
        entry = number;
        return;
      }
      const CreasePoint& q = *points_[static_cast<std::size_t>(entry)];
      const Point to_p = p.position - pixel, to_q = q.position - pixel;
      const double square = graph::dot(to_p, to_p), other = graph::dot(to_q, to_q);
      if (square > (1 + kSure) * other) return;
      const auto rank = [](const CreasePoint& point, Point away) {
        return std::pair(graph::norm(away), -point.strength);
      };
      if (square < (1 - kSure) * other || rank(p, to_p) < rank(q, to_q)) entry = number;
    });
  }

  template <class Visit>
  void visit(const Box& box, Visit act) {
    for (int y = std::max(box.top, 0); y <= std::min(box.bottom, index_.rows - 1); ++y)
      for (int x = std::max(box.left, 0); x <= std::min(box.right, index_.cols - 1); ++x)
        act(index_(y, x), Point{static_cast<double>(x), static_cast<double>(y)});
  }

  cv::Mat1i index_;
  std::vector<const CreasePoint*> points_;
  std::vector<Line> lines_;
};

// Counter-lobe of the line through q at p, seen at scale sigma: its second derivative there, of the sign
// opposite to the line's own. 0 near the line.
double lobe(const CreasePoint& q, Point p, double sigma, const ScaleSpace& space) {
  const double s = space[static_cast<std::size_t>(q.level)].sigma, spread2 = s * s + sigma * sigma;
  const Point away = p - q.position;
  if (graph::dot(away, away) < 0.999 * spread2) return 0;
  const double d2 = std::pow(graph::distance(p, q.position), 2) / spread2;
  return std::max(0.0, q.contrast * s * std::pow(spread2, -1.5) * (d2 - 1) * std::exp(-0.5 * d2));
}

/// The share of a line's response that lines of the other sign explain.
double explained(const Chain& chain, const Accepted& opposite, const ScaleSpace& space) {
  constexpr double kReach = 4;  // reach in S of a line as wide as this one
  const std::size_t own = median_level(chain.points, space);
  const double sigma = space[own].sigma, reach = kReach * 1.5 * sigma + 4;
  double seen = 0, predicted = 0;
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    const Point p = chain.points[i].position, u = tangent(chain, i), across{-u.y, u.x};
    seen += std::abs(space[own].hessian_at(p).along(across));
    for (const Point side : {across, across * -1})
      if (const CreasePoint* q = opposite.first_on(p, side, reach);
          q != nullptr && space[static_cast<std::size_t>(q->level)].channel == space[own].channel)
        predicted += lobe(*q, p, sigma, space);
  }
  return seen > 0 ? predicted / seen : 0;
}

// Lines respond to half their scale at least nearly as much as to their own (a Gaussian one 2.0 times, a box
// 0.84 times); blurred flanks with flat ground between them do not.
bool blurred_ground(const Chain& chain, const ScaleSpace& space) {
  constexpr double kLeast = 0.65;
  const std::size_t own = median_level(chain.points, space);
  if (space[own].octave < 2) return false;
  double at_own = 0, at_half = 0;
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    const Point p = chain.points[i].position, u = tangent(chain, i), across{-u.y, u.x};
    at_own += space[own].hessian_at(p).along(across);
    at_half += space[own - 2].hessian_at(p).along(across);
  }
  return at_half * at_own < 0 || std::abs(at_half) < kLeast * std::abs(at_own);
}

/// Tells whether a line is the ground between two lines of the other sign, seen there as beyond them: it
/// falls no farther below them than what lies on their other sides, where no line of its own sign is near.
bool is_ground_between(const Chain& chain, const Accepted& opposite, const Accepted& same,
                       const ScaleSpace& space) {
  constexpr double kReach = 4, kBeyond = 3;      // of a scale
  constexpr double kShare = 0.6, kBelow = 0.25;  // of the points; of the lines' contrast
  const ScaleLevel& own = space[median_level(chain.points, space)];
  const double sign = chain.kind == CreaseKind::valley ? 1 : -1, reach = kReach * 1.5 * own.sigma + 4;
  const auto level_at = [&](Point p) { return sign * core::sample_bilinear(own.frame, p.x, p.y); };
  std::vector<double> below, contrast;
  for (std::size_t i = 0; i < chain.points.size(); ++i) {
    const Point p = chain.points[i].position, u = tangent(chain, i), across{-u.y, u.x};
    double ground = 0, line = 0;
    int sides = 0;
    for (const Point side : {across, across * -1}) {
      const CreasePoint* q = opposite.first_on(p + side * own.sigma, side, reach);
      if (q == nullptr) break;
      const double scale = space[static_cast<std::size_t>(q->level)].sigma;
      const Point at = p + side * graph::dot(q->position - p, side);
      const double beyond = kBeyond * scale;
      if (same.first_on(at, side, beyond + own.sigma) != nullptr) break;
      ground += level_at(at + side * beyond), line += level_at(at), ++sides;
    }
    if (sides < 2) continue;
    below.push_back(0.5 * ground - level_at(p));
    contrast.push_back(0.5 * (line - ground));
  }
  if (static_cast<double>(below.size()) < kShare * static_cast<double>(chain.points.size())) return false;
  return core::median(std::move(below)) < kBelow * core::median(std::move(contrast));
}

double mean_strength(const Chain& chain) {
  return std::accumulate(chain.points.begin(), chain.points.end(), 0.0,
                         [](double sum, const CreasePoint& p) { return sum + p.strength; }) /
         static_cast<double>(chain.points.size());
}

// The lines that were accepted, and which of them were dropped.
struct Judged {
  Accepted ridges, valleys;
  std::vector<double> share;  // of its response that stronger lines explain, of each chain
  std::vector<bool> dropped;

  [[nodiscard]] Accepted& of(CreaseKind kind) { return kind == CreaseKind::ridge ? ridges : valleys; }
  [[nodiscard]] Accepted& opposite(CreaseKind kind) { return kind == CreaseKind::ridge ? valleys : ridges; }
};

// Judges each accepted line again by all others. A line between two lines of the other sign may have come
// before the weaker one, and was then judged by the stronger one alone.
void drop_between(const std::vector<Chain>& chains, const std::vector<std::size_t>& order,
                  const ScaleSpace& space, Judged& judged) {
  constexpr double kLeast = 0.2;  // of the response: less was explained by the stronger of the two
  for (const std::size_t c : order) {
    if (judged.dropped[c] || chains[c].kind == CreaseKind::step) continue;
    const auto &same = judged.of(chains[c].kind), &opposite = judged.opposite(chains[c].kind);
    const bool is_lobe = judged.share[c] >= kLeast && explained(chains[c], opposite, space) * kOfAll > 1;
    if (!is_lobe && !is_ground_between(chains[c], opposite, same, space)) continue;
    judged.dropped[c] = true;
    judged.of(chains[c].kind).remove(chains[c]);
  }
}

}  // namespace

std::vector<Chain> remove_lobe_curves(std::vector<Chain> chains, const ScaleSpace& space, cv::Size frame) {
  std::vector<double> strength;
  for (const Chain& chain : chains) strength.push_back(mean_strength(chain));
  std::vector<std::size_t> order(chains.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return strength[a] > strength[b]; });
  Judged judged{Accepted(frame), Accepted(frame), std::vector<double>(chains.size(), 0),
                std::vector<bool>(chains.size(), false)};
  for (const std::size_t c : order) {
    const Chain& chain = chains[c];
    if (chain.kind == CreaseKind::step) continue;
    judged.share[c] = explained(chain, judged.opposite(chain.kind), space);
    judged.dropped[c] = judged.share[c] * kOfOne > 1 || blurred_ground(chain, space);
    if (!judged.dropped[c]) judged.of(chain.kind).add(chain);
  }
  drop_between(chains, order, space, judged);
  std::vector<Chain> kept;
  for (std::size_t c = 0; c < chains.size(); ++c)
    if (!judged.dropped[c]) kept.push_back(std::move(chains[c]));
  return kept;
}

}  // namespace emberfold::sketch
