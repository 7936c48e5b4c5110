// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/figures/polyline.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace emberfold::figures {

double Segment::theta() const {
  return std::atan2(b.y - a.y, b.x - a.x);
}

std::vector<Segment> pieces(std::span<const Point> curve, double sigma) {
  std::vector<Segment> result;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
    result.push_back({curve[i], curve[i + 1], i == 0, i + 2 == curve.size(), sigma});
  return result;
}

std::vector<Segment> pieces(const graph::AttributeGraph& graph, Kind kind) {
  std::vector<Segment> result;
  for (const graph::Edge& edge : graph.edges()) {
    const std::size_t a = graph.index_of(edge.a), b = graph.index_of(edge.b);
    const bool step = graph::on_step(graph.patch(a)) && graph::on_step(graph.patch(b));
    if (kind == Kind::all || step == (kind == Kind::steps))
      result.push_back(
          {graph.patch(a).position, graph.patch(b).position, graph.degree(a) == 1, graph.degree(b) == 1, 0});
  }
  return result;
}

std::vector<Sample> samples(std::span<const Segment> curve) {
  std::vector<Sample> result;
  for (const Segment& s : curve) {
    const double length = s.length(), theta = s.theta();
    const int parts = std::max(1, static_cast<int>(std::ceil(length / 0.5)));
    for (int i = 0; i < parts; ++i)
      result.push_back({s.a + (s.b - s.a) * ((i + 0.5) / parts), theta, length / parts});
  }
  return result;
}

double distance(const Segment& segment, Point p) {
  const Point along = segment.b - segment.a;
  const double square = graph::dot(along, along);
  const double t = square > 0 ? std::clamp(graph::dot(p - segment.a, along) / square, 0.0, 1.0) : 0;
  return graph::distance(p, segment.a + along * t);
}

bool near(std::span<const Segment> curves, Point p, double reach) {
  return std::ranges::any_of(curves, [&](const Segment& s) { return distance(s, p) <= reach; });
}

bool runs_along(std::span<const Segment> curves, const Sample& sample, double reach, double angle) {
  return std::ranges::any_of(curves, [&](const Segment& s) {
    return distance(s, sample.position) <= reach &&
           graph::orientation_difference(s.theta(), sample.theta) <= angle;
  });
}

bool behind_an_end(std::span<const Segment> curves, Point p, double reach) {
  const auto behind = [&](Point end, Point before, double sigma) {
    const double length = graph::distance(end, before);
    if (length <= 0) return false;
    const Point out = (end - before) * (1 / length), off = p - end;
    const double along = graph::dot(off, out), across = off.y * out.x - off.x * out.y;
    return along >= 0 && along <= 2 * sigma && std::abs(across) <= reach;
  };
  return std::ranges::any_of(curves, [&](const Segment& s) {
    return (s.a_ends && behind(s.a, s.b, s.sigma)) || (s.b_ends && behind(s.b, s.a, s.sigma));
  });
}

std::size_t pair_off(std::span<const Point> a, std::span<const Point> b, double radius) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      if (const double d = graph::distance(a[i], b[j]); d <= radius) candidates.emplace_back(d, i, j);
  std::ranges::sort(candidates);
  std::vector<bool> a_taken(a.size()), b_taken(b.size());
  std::size_t pairs = 0;
  for (const auto& [d, i, j] : candidates) {
    if (a_taken[i] || b_taken[j]) continue;
    a_taken[i] = b_taken[j] = true;
    ++pairs;
  }
  return pairs;
}

std::size_t count_near(std::span<const Point> points, std::span<const Point> others, double radius) {
  return static_cast<std::size_t>(std::ranges::count_if(points, [&](Point p) {
    return std::ranges::any_of(others, [&](Point o) { return graph::distance(p, o) <= radius; });
  }));
}

std::vector<Point> positions(const graph::AttributeGraph& graph, std::size_t least_degree) {
  std::vector<Point> result;
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (graph.degree(i) >= least_degree) result.push_back(graph.patch(i).position);
  return result;
}

}  // namespace emberfold::figures
