// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"
#include "graph/patch.hpp"

namespace emberfold::figures {

using graph::Point;

/// A straight piece of a curve.
struct Segment {
  Point a, b;
  bool a_ends = false, b_ends = false;  ///< whether the curve ends there
  double sigma = 0;                     ///< px, the stroke's scale, where it is known

  [[nodiscard]] double length() const { return graph::distance(a, b); }
  [[nodiscard]] double theta() const;
};

/// A curve's pieces; fewer than two points have none.
std::vector<Segment> pieces(std::span<const Point> curve, double sigma = 0);

/// The edges of a graph: all, or those of lines, or of steps.
enum class Kind { all, lines, steps };
std::vector<Segment> pieces(const graph::AttributeGraph& graph, Kind kind);

/// A place on a curve and the length that it stands for.
struct Sample {
  Point position;
  double theta = 0;
  double length = 0;
};
/// The middles of equal parts of at most half a pixel.
std::vector<Sample> samples(std::span<const Segment> curve);

double distance(const Segment& segment, Point p);

/// Returns whether any of the curves comes within `reach` px.
bool near(std::span<const Segment> curves, Point p, double reach);
/// Returns whether such a curve also runs in a direction within `angle` rad of the sample's.
bool runs_along(std::span<const Segment> curves, const Sample& sample, double reach, double angle);

/// Returns whether p lies behind a curve's end: at most 2σ on in its direction, at most `reach` px aside.
bool behind_an_end(std::span<const Segment> curves, Point p, double reach);

/// Counts the points of both sets that pair off one to one within `radius` px, nearest first.
std::size_t pair_off(std::span<const Point> a, std::span<const Point> b, double radius);

/// Counts the points that have one of `others` within `radius` px.
std::size_t count_near(std::span<const Point> points, std::span<const Point> others, double radius);

/// Lists the positions of the graph's vertices; all, or those with at least three edges.
std::vector<Point> positions(const graph::AttributeGraph& graph, std::size_t least_degree = 0);

}  // namespace emberfold::figures
