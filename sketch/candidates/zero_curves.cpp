// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/zero_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "sketch/detection/crease_map.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// A pixel's derivatives, as far as edges depend on them; no edge runs next to one without a normal.
struct Corner {
  Point normal;       // unit, along the gradient
  double second = 0;  // derivative along it
  double gradient = 0;
};

// Where an edge crosses the line between two neighbouring pixels.
struct Crossing {
  Point position, normal;
  double gradient = 0;
  std::array<int, 2> next = {-1, -1};
};

Corner make_corner(const float* up, const float* mid, const float* down, double least_gradient) {
  const Point g = gradient_of(up, mid, down);
  const double size = norm(g);
  if (size < least_gradient) return {};
  const Point n = g * (1 / size);
  return {n, hessian_of(up, mid, down).along(n), size};
}

// Marching squares, row after row: the cells' corners are pixels.
class Tracer {
 public:
  explicit Tracer(int width)
      : width_(static_cast<std::size_t>(width)), above_(width_, -1), along_(width_), down_(width_) {}

  void add_row(int y, const std::vector<Corner>& row, const std::vector<Corner>& before) {
    const auto at = [](std::size_t x, int line) {
      return Point{static_cast<double>(x), static_cast<double>(line)};
    };
    for (std::size_t x = 0; x + 1 < width_; ++x) along_[x] = cross(row[x], row[x + 1], at(x, y), {1, 0});
    if (y > 0) {
      for (std::size_t x = 0; x < width_; ++x) down_[x] = cross(before[x], row[x], at(x, y - 1), {0, 1});
      for (std::size_t x = 0; x + 1 < width_; ++x) link({above_[x], along_[x], down_[x], down_[x + 1]});
    }
    std::swap(above_, along_);
  }

  // Calls visit(crossings in order, closed) for every curve, open ones first.
  template <class Visit>
  void visit_curves(const Visit& visit) const {
    std::vector<char> seen(crossings_.size(), 0);
    const auto open = [&](int i) { return i >= 0 && seen[static_cast<std::size_t>(i)] == 0; };
    std::vector<const Crossing*> curve;
    for (const bool closed : {false, true})
      for (std::size_t i = 0; i < crossings_.size(); ++i) {
        const auto& next = crossings_[i].next;
        if (seen[i] != 0 || (!closed && next[0] >= 0 && next[1] >= 0)) continue;
        curve.clear();
        for (int at = static_cast<int>(i); at >= 0;) {
          const Crossing& c = crossings_[static_cast<std::size_t>(at)];
          seen[static_cast<std::size_t>(at)] = 1;
          curve.push_back(&c);
          at = open(c.next[0]) ? c.next[0] : open(c.next[1]) ? c.next[1] : -1;
        }
        visit(curve, closed);
      }
  }

 private:
  int cross(const Corner& a, const Corner& b, Point from, Point step) {
    if (a.gradient <= 0 || b.gradient <= 0 || (a.second < 0) == (b.second < 0) ||
        dot(a.normal, b.normal) <= 0)
      return -1;
    const double t = a.second / (a.second - b.second);
    const Point n = a.normal * (1 - t) + b.normal * t;
    // The gradient is greatest there, not least: the second derivative falls along the normal.
    if ((b.second - a.second) * dot(step, n) >= 0) return -1;
    crossings_.push_back(
        {from + step * t, n * (1 / norm(n)), (1 - t) * a.gradient + t * b.gradient, {-1, -1}});
    return static_cast<int>(crossings_.size()) - 1;
  }

  Crossing& crossing(int i) { return crossings_[static_cast<std::size_t>(i)]; }

  void join(int a, int b) {
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
      auto& next = crossing(from).next;
      (next[0] < 0 ? next[0] : next[1]) = to;
    }
  }

  // Joins the crossings of a cell's sides (above, below, left, right), those that are nearest and turn least.
  void link(const std::array<int, 4>& sides) {
    std::array<int, 4> met{};
    std::size_t count = 0;
    for (const int s : sides)
      if (s >= 0) met[count++] = s;
    const auto cost = [&](std::size_t i, std::size_t j) {
      const Crossing &a = crossing(met[i]), &b = crossing(met[j]);
      return distance(a.position, b.position) + 1 - dot(a.normal, b.normal);
    };
    if (count == 2) join(met[0], met[1]);
    if (count == 3) {  // a branch: the third ends here
      std::array<std::pair<double, std::array<int, 2>>, 3> pairs = {
          {{cost(0, 1), {0, 1}}, {cost(0, 2), {0, 2}}, {cost(1, 2), {1, 2}}}};
      const auto& [i, j] = std::min_element(pairs.begin(), pairs.end())->second;
      join(met[static_cast<std::size_t>(i)], met[static_cast<std::size_t>(j)]);
    }
    if (count == 4) {
      const bool first = cost(0, 2) + cost(1, 3) <= cost(0, 3) + cost(1, 2);
      join(met[0], met[first ? 2 : 3]);
      join(met[1], met[first ? 3 : 2]);
    }
  }

  std::size_t width_;
  std::vector<int> above_, along_, down_;  // crossings of the rows of sides, −1: none
  std::vector<Crossing> crossings_;
};

// Returns whether a curve's ends are neighbours: where edges touch, a side is met three times, and a ring
// may be left open there.
bool ends_touch(const std::vector<const Crossing*>& curve) {
  constexpr double kTouching = 1.5;         // px
  constexpr std::size_t kFewestOfRing = 8;  // points
  return curve.size() >= kFewestOfRing &&
         distance(curve.front()->position, curve.back()->position) < kTouching;
}

Chain make_chain(const std::vector<const Crossing*>& curve, bool closed, double to_contrast, int index) {
  Chain chain{CreaseKind::step, {}, closed || ends_touch(curve), {0, 0}};
  chain.points.reserve(curve.size());
  for (const Crossing* c : curve) {
    CreasePoint p;
    p.position = c->position;
    p.theta = std::atan2(-c->normal.x, c->normal.y);
    p.strength = c->gradient;
    p.contrast = to_contrast * c->gradient;
    p.level = index;
    chain.points.push_back(p);
  }
  return chain;
}

// Lets the brighter side be to the right of a curve, along which it is entered at either end.
void turn_bright_side_right(std::vector<const Crossing*>& curve) {
  double right = 0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Point step = curve[i]->position - curve[i - 1]->position;
    right += dot({-step.y, step.x}, curve[i]->normal + curve[i - 1]->normal);
  }
  if (right < 0) std::ranges::reverse(curve);
}

}  // namespace

std::vector<Chain> trace_edges(const ScaleLevel& level, int index, double least_gradient) {
  constexpr std::size_t kFewest = 5;
  const int width = level.smooth.cols - 2, height = level.smooth.rows - 2;
  Tracer tracer(width);
  std::vector<Corner> row(static_cast<std::size_t>(width)), before(row.size());
  for (int y = 0; y < height; ++y) {
    const float *up = level.smooth[y], *mid = level.smooth[y + 1], *down = level.smooth[y + 2];
    for (int x = 0; x < width; ++x)
      row[static_cast<std::size_t>(x)] = make_corner(up + x, mid + x, down + x, least_gradient);
    tracer.add_row(y, row, before);
    std::swap(row, before);
  }
  std::vector<Chain> chains;
  tracer.visit_curves([&](std::vector<const Crossing*>& curve, bool closed) {
    if (curve.size() < kFewest) return;
    turn_bright_side_right(curve);
    chains.push_back(make_chain(curve, closed, step_contrast(level.sigma), index));
  });
  return chains;
}

}  // namespace emberfold::sketch
