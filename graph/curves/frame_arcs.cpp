// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/frame_arcs.hpp"

#include <algorithm>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::graph::detail {

namespace {

constexpr double kShortArc = 15;          // px: junctions so near are one knot
constexpr std::size_t kMostTogether = 6;  // of a knot: more are not taken together

double length_of(const AttributeGraph& graph, const Curve& curve) {
  double sum = 0;
  for (std::size_t k = 1; k < curve.size(); ++k)
    sum += distance(graph.patch(curve[k - 1]).position, graph.patch(curve[k]).position);
  return sum;
}

bool is_junction(const AttributeGraph& graph, std::uint32_t v) {
  return graph.degree(v) >= 3;
}

/// Joins junctions that short curves connect; tells which curves those are.
class Knots {
 public:
  Knots(const AttributeGraph& graph, const std::vector<Curve>& all)
      : absorbed(all.size(), false), rank_(graph.size()), parent_(graph.size()), arms_(graph.size(), 0) {
    for (std::size_t v = 0; v < graph.size(); ++v) sets_.make_set(v);
    for (std::size_t v = 0; v < graph.size(); ++v) arms_[v] = graph.degree(v);
    std::vector<std::pair<double, std::size_t>> between;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Curve& curve = all[k];
      if (curve.size() < 2 || !is_junction(graph, curve.front()) || !is_junction(graph, curve.back()))
        continue;
      between.emplace_back(curve.size() == 2 ? 0 : length_of(graph, curve), k);
    }
    std::sort(between.begin(), between.end());
    for (const auto& [length, k] : between) {
      if (length > kShortArc) break;
      const std::size_t a = sets_.find_set(all[k].front()), b = sets_.find_set(all[k].back());
      const std::size_t arms = a == b ? arms_[a] - 2 : arms_[a] + arms_[b] - 2;
      if (arms > kMostTogether && all[k].size() > 2) continue;
      if (a != b) sets_.link(a, b);
      arms_[sets_.find_set(a)] = arms;
      absorbed[k] = true;
    }
  }
  std::size_t find(std::uint32_t v) { return sets_.find_set(std::size_t{v}); }

  std::vector<bool> absorbed;

 private:
  std::vector<std::size_t> rank_, parent_, arms_;
  boost::disjoint_sets<std::size_t*, std::size_t*> sets_{rank_.data(), parent_.data()};
};

}  // namespace

FrameArcs::FrameArcs(const AttributeGraph& g)
    : graph(&g), arc_of(g.size(), kNoIndex), index_of(g.size(), kNoIndex), knot_of(g.size(), kNoIndex) {
  const std::vector<Curve> all = curves(g);
  Knots joined(g, all);
  std::vector<std::uint32_t> number(g.size(), kNoIndex);
  for (std::uint32_t v = 0; v < g.size(); ++v) {
    if (!is_junction(g, v)) continue;
    std::uint32_t& knot = number[joined.find(v)];
    if (knot == kNoIndex) {
      knot = static_cast<std::uint32_t>(knots.size());
      knots.emplace_back();
    }
    knot_of[v] = knot;
    knots[knot].vertices.push_back(v);
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (joined.absorbed[k]) {
      for (std::size_t i = 1; i + 1 < all[k].size(); ++i) {
        knot_of[all[k][i]] = knot_of[all[k].front()];
        knots[knot_of[all[k].front()]].vertices.push_back(all[k][i]);
      }
      continue;
    }
    Arc arc{all[k]};
    const auto number_of_arc = static_cast<std::uint32_t>(arcs.size());
    arc.front_knot = knot_of[arc.path.front()], arc.back_knot = knot_of[arc.path.back()];
    if (arc.back_knot != kNoIndex) arc.path.pop_back();
    if (arc.front_knot != kNoIndex) arc.path.erase(arc.path.begin());
    if (arc.front_knot == kNoIndex && arc.path.size() > 2 && arc.path.front() == arc.path.back()) {
      arc.path.pop_back();
      arc.closed = true;
    }
    if (arc.front_knot != kNoIndex) knots[arc.front_knot].arms.push_back({number_of_arc, true});
    if (arc.back_knot != kNoIndex) knots[arc.back_knot].arms.push_back({number_of_arc, false});
    for (std::uint32_t i = 0; i < arc.path.size(); ++i) {
      arc_of[arc.path[i]] = number_of_arc;
      index_of[arc.path[i]] = i;
    }
    arcs.push_back(std::move(arc));
  }
}

std::vector<std::uint32_t> FrameArcs::way(std::uint32_t arc, std::uint32_t from, bool up,
                                          double reach) const {
  const auto& path = arcs[arc].path;
  const std::size_t n = path.size();
  std::vector<std::uint32_t> result{path[from]};
  std::size_t k = from;
  for (double walked = 0; walked < reach && result.size() < n;) {
    if (!arcs[arc].closed && (up ? k + 1 == n : k == 0)) break;
    k = up ? (k + 1) % n : (k + n - 1) % n;
    walked += distance(at(result.back()), at(path[k]));
    result.push_back(path[k]);
  }
  return result;
}

std::vector<std::uint32_t> FrameArcs::way(const Arm& arm, double reach) const {
  const auto last = static_cast<std::uint32_t>(arcs[arm.arc].path.size() - 1);
  return way(arm.arc, arm.front ? 0 : last, arm.front, reach);
}

bool FrameArcs::near(std::uint32_t a, std::uint32_t b, int hops) const {
  std::vector<std::uint32_t> seen{a};
  std::size_t begin = 0;
  for (int hop = 0; hop <= hops; ++hop) {
    const std::size_t end = seen.size();
    for (; begin < end; ++begin) {
      if (seen[begin] == b) return true;
      for (const std::uint32_t w : graph->neighbours(seen[begin]))
        if (std::find(seen.begin(), seen.end(), w) == seen.end()) seen.push_back(w);
    }
  }
  return false;
}

}  // namespace emberfold::graph::detail
