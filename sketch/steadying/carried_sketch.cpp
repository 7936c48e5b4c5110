// SPDX-License-Identifier: Apache-2.0
#include "sketch/steadying/carried_sketch.hpp"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace emberfold::sketch {

using graph::Point;

Point sample_motion(const cv::Mat& motion, cv::Size size, Point p) {
  const auto place = [](double at, int full, int count) {
    return std::clamp((at + 0.5) * count / full - 0.5, 0.0, count - 1.0);
  };
  const double x = place(p.x, size.width, motion.cols), y = place(p.y, size.height, motion.rows);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, motion.cols - 1), below = std::min(top + 1, motion.rows - 1);
  const double u = x - left, v = y - top;
  const auto at = [&](int row, int column) {
    const auto& value = motion.at<cv::Vec2f>(row, column);
    return Point{double{value[0]}, double{value[1]}};
  };
  return (at(top, left) * (1 - u) + at(top, right) * u) * (1 - v) +
         (at(below, left) * (1 - u) + at(below, right) * u) * v;
}

graph::AttributeGraph carry_sketch(const graph::AttributeGraph& graph, const cv::Mat& motion, cv::Size size) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (graph::Vertex& v : vertices)
    v.patch.position = v.patch.position + sample_motion(motion, size, v.patch.position);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

cv::Mat1f measure_difference(const cv::Mat1f& luma, const cv::Mat1f& other, const cv::Mat& motion) {
  constexpr double kWindow = 3;  // px, SD
  cv::Mat map;
  cv::resize(motion, map, luma.size(), 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < map.rows; ++y) {
    auto* row = map.ptr<cv::Vec2f>(y);
    for (int x = 0; x < map.cols; ++x) row[x] += cv::Vec2f(static_cast<float>(x), static_cast<float>(y));
  }
  cv::Mat1f carried, squares;
  cv::remap(other, carried, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  squares = carried - luma;
  squares = squares.mul(squares);
  cv::GaussianBlur(squares, squares, {}, kWindow);
  cv::sqrt(squares, squares);
  return squares;
}

}  // namespace emberfold::sketch
