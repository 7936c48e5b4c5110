// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/flanks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/math/robust.hpp"
#include "sketch/patches/patch_types.hpp"

namespace emberfold::sketch {

namespace {

using graph::AttributeGraph;
using graph::Curve;
using graph::Patch;
using graph::Point;

constexpr double kBeside = 3;      // px between the edges of what runs side by side
constexpr double kAlongPatch = 4;  // px along a patch within which a neighbour is searched
constexpr double kParallel = 0.5;  // rad
constexpr double kNarrower = 0.7;  // of a curve's width: what makes it a flank is at most so wide
constexpr double kOfLine = 0.85;   // of a curve's contrast: the least of a line that it may flank
constexpr double kStepGain = 0.7;  // of a line's gain: a flank that is a step saves at most so much
constexpr double kRamp = 3;        // blurs: the width of a step
constexpr double kShare = 0.4;     // of a curve's patches

double width(const Patch& patch) {
  return graph::on_step(patch) ? kRamp * patch.blur : patch.width;
}

/// Patches by the cell of a grid that they lie in.
class Cells {
 public:
  Cells(const AttributeGraph& graph, double side) : side_(side) {
    places_.reserve(graph.size());
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
      const Patch& patch = graph.patch(i);
      places_.push_back({key(patch.position, 0, 0), patch.position, width(patch), i});
    }
    std::ranges::sort(places_, {}, [](const Place& place) { return std::pair(place.key, place.index); });
  }

  /// Returns whether `match` holds for a patch beside one at p of this width, not farther off than
  /// lies_beside() allows.
  template <class Match>
  [[nodiscard]] bool any_near(Point p, double width, const Match& match) const {
    for (int dy = -1; dy <= 1; ++dy) {
      const std::int64_t last = key(p, 1, dy);
      for (auto at = std::ranges::lower_bound(places_, key(p, -1, dy), {}, &Place::key);
           at != places_.end() && at->key <= last; ++at) {
        const Point off = at->position - p;
        const double across = 0.5 * (width + at->width) + kBeside;
        if (dot(off, off) <= kMore * (kAlongPatch * kAlongPatch + across * across) && match(at->index))
          return true;
      }
    }
    return false;
  }

 private:
  static constexpr double kMore = 1.000001;  // than rounding makes

  struct Place {
    std::int64_t key;
    Point position;
    double width;
    std::uint32_t index;
  };

  [[nodiscard]] std::int64_t key(Point p, int dx, int dy) const {
    const auto cell = [&](double at) { return static_cast<std::int64_t>(std::floor(at / side_)); };
    return (cell(p.y) + dy) * (std::int64_t{1} << 32) + cell(p.x) + dx;
  }

  double side_;
  std::vector<Place> places_;  // by their cells
};

double median_width(const AttributeGraph& graph, const Curve& curve) {
  std::vector<double> widths;
  for (const auto v : curve) widths.push_back(width(graph.patch(v)));
  return core::median(std::move(widths));
}

/// True if `patch`, of a curve of this width, may be a flank of the line `other`.
bool may_flank(const Patch& patch, double width, const Patch& other, double of_step) {
  if (graph::on_step(other)) return false;
  const double contrast = std::abs(patch.contrast), line = std::abs(other.contrast);
  if (graph::on_step(patch)) return line >= of_step * contrast && patch.gain <= kStepGain * other.gain;
  return other.contrast * patch.contrast < 0 && line >= kOfLine * contrast &&
         other.width <= kNarrower * width;
}

bool lies_beside(const Patch& patch, double width, const Patch& other) {
  const Point along{std::cos(patch.theta), std::sin(patch.theta)}, off = other.position - patch.position;
  const double across = std::abs(off.y * along.x - off.x * along.y);
  return std::abs(dot(off, along)) <= kAlongPatch && across <= 0.5 * (width + other.width) + kBeside &&
         graph::orientation_difference(patch.theta, other.theta) <= kParallel;
}

class Flanks {
 public:
  Flanks(const AttributeGraph& graph, double of_step)
      : graph_(graph),
        of_step_(of_step),
        curves_(curves(graph)),
        cells_(graph, reach(graph)),
        gone_(graph.size(), false),
        asked_of_(graph.size(), 0) {
    for (const Curve& curve : curves_) width_.push_back(median_width(graph, curve));
  }

  /// Which vertices go. Narrow lines come first: what makes a wide one a flank stays.
  std::vector<bool> find() {
    std::vector<std::size_t> order(curves_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto rank = [&](std::size_t c) {  // steps last
      return std::pair(graph::on_step(graph_.patch(curves_[c][curves_[c].size() / 2])), width_[c]);
    };
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    for (const std::size_t c : order)
      if (is_flank(curves_[c], width_[c]))
        for (const auto v : curves_[c])
          if (graph_.degree(v) <= 2) gone_[v] = true;
    for (std::size_t v = 0; v < graph_.size(); ++v)  // meetings of curves that are all gone
      if (graph_.degree(v) > 2 && std::ranges::all_of(graph_.neighbours(v), [&](auto n) { return gone_[n]; }))
        gone_[v] = true;
    return gone_;
  }

 private:
  static double reach(const AttributeGraph& graph) {
    double widest = 0;
    for (const auto& v : graph.vertices()) widest = std::max(widest, width(v.patch));
    return std::hypot(kAlongPatch, widest + kBeside);
  }

  [[nodiscard]] bool is_flank(const Curve& curve, double width) {
    ++asked_;
    for (const auto v : curve) asked_of_[v] = asked_;
    const auto flanked = [&](std::uint32_t v) {
      const Patch& patch = graph_.patch(v);
      return cells_.any_near(patch.position, width, [&](std::uint32_t other) {
        return !gone_[other] && asked_of_[other] != asked_ &&
               may_flank(patch, width, graph_.patch(other), of_step_) &&
               lies_beside(patch, width, graph_.patch(other));
      });
    };
    return static_cast<double>(std::ranges::count_if(curve, flanked)) >=
           kShare * static_cast<double>(curve.size());
  }

  const AttributeGraph& graph_;
  double of_step_;
  std::vector<Curve> curves_;
  std::vector<double> width_;
  Cells cells_;
  std::vector<bool> gone_;
  std::vector<std::size_t> asked_of_;  // which curve a vertex was last asked of: a meeting lies on several
  std::size_t asked_ = 0;
};

}  // namespace

AttributeGraph remove_flank_curves(const AttributeGraph& graph, double of_step) {
  const std::vector<bool> gone = Flanks(graph, of_step).find();
  if (std::ranges::find(gone, true) == gone.end()) return graph;
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::size_t i = 0; i < graph.size(); ++i)
    if (!gone[i]) vertices.push_back(graph.vertices()[i]);
  const auto stays = [&](graph::VertexId id) { return !gone[graph.index_of(id)]; };
  std::ranges::copy_if(graph.edges(), std::back_inserter(edges),
                       [&](const graph::Edge& e) { return stays(e.a) && stays(e.b); });
  return name_patch_types(std::move(vertices), std::move(edges));
}

}  // namespace emberfold::sketch
