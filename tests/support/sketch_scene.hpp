// SPDX-License-Identifier: Apache-2.0
// Frames whose structure is known exactly: blurred bars, rings and steps as formulas, sampled at pixel
// centres, and white noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::test {

using graph::Point;

inline Point unit(double theta) {
  return {std::cos(theta), std::sin(theta)};
}

/// The share of a step, blurred by a Gaussian of SD `blur`, that is reached at distance d past it.
inline double reached(double d, double blur) {
  return 0.5 * std::erfc(-d / (blur * std::numbers::sqrt2));
}

/// Returns the visible share of a blurred bar at distance d from its middle, 0…1.
inline double seen(double d, double width, double blur) {
  return reached(d + width / 2, blur) - reached(d - width / 2, blur);
}

/// Returns the level of a blurred bar with its sides at distance d from its middle: graph::Patch's profile.
inline double bar_level(double d, double width, double blur, double left, double middle, double right) {
  return left + (middle - left) * reached(d + width / 2, blur) +
         (right - middle) * reached(d - width / 2, blur);
}

/// Visible share of a shape at a place, 0…1.
using Cover = std::function<double(Point)>;

/// A rectangle about the way from a to b, blurred by a Gaussian: exact.
inline Cover segment(Point a, Point b, double width, double blur) {
  const Point middle = (a + b) * 0.5;
  const double length = graph::distance(a, b);
  const Point along = (b - a) * (1 / length), across{-along.y, along.x};
  return [=](Point p) {
    return seen(graph::dot(p - middle, along), length, blur) *
           seen(graph::dot(p - middle, across), width, blur);
  };
}

/// A bar bent to a circle: its profile at the distance from the circle.
inline Cover ring(Point centre, double radius, double width, double blur) {
  return [=](Point p) { return seen(graph::distance(p, centre) - radius, width, blur); };
}

/// level(p) at every pixel centre.
inline cv::Mat1f draw(cv::Size size, const std::function<double(Point)>& level) {
  cv::Mat1f frame(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      frame(y, x) = static_cast<float>(level({static_cast<double>(x), static_cast<double>(y)}));
  return frame;
}

/// Shapes of one brightness over one another, on even ground.
inline cv::Mat1f draw(cv::Size size, const std::vector<Cover>& shapes, double ground, double contrast) {
  return draw(size, [&](Point p) {
    double bare = 1;
    for (const Cover& shape : shapes) bare *= 1 - shape(p);
    return ground + contrast * (1 - bare);
  });
}

inline cv::Mat1f with_noise(const cv::Mat1f& frame, double sd, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat1f noisy = frame.clone();
  for (float& level : noisy) level += static_cast<float>(sd * rng.normal());
  return noisy;
}

/// Returns whether the frame's border is at least `margin` px away.
inline bool well_inside(Point p, cv::Size size, double margin) {
  return p.x >= margin && p.y >= margin && p.x <= size.width - 1 - margin && p.y <= size.height - 1 - margin;
}

/// Counts the vertices of this degree.
inline std::size_t count_degree(const graph::AttributeGraph& graph, std::size_t degree) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < graph.size(); ++i) count += graph.degree(i) == degree ? 1U : 0U;
  return count;
}

}  // namespace emberfold::test
