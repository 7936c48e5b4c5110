// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/relight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "sketch/rendering/curve_bands.hpp"

namespace emberfold::sketch {

namespace {

constexpr int evening = 3;     // rounds of means over a patch and its neighbours
constexpr int beside = 5;      // px, side of the square over which a ground's level is taken
constexpr double apart = 1.5;  // px from the profile's end to its middle

/// By how much the sides give way, by channel: those of the left, then those of the right.
using Lift = std::array<float, 6>;

graph::Level level_at(const cv::Mat& background, graph::Point place) {
  const int x = std::clamp(static_cast<int>(std::lround(place.x)), 0, background.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(place.y)), 0, background.rows - 1);
  const auto* pixel = background.ptr<float>(y) + x * background.channels();
  return background.channels() == 1 ? graph::Level{pixel[0], pixel[0], pixel[0]}
                                    : graph::Level{pixel[0], pixel[1], pixel[2]};
}

Lift lift(const graph::Patch& patch, const cv::Mat& background) {
  const graph::Point aside =
      graph::Point{-std::sin(patch.theta), std::cos(patch.theta)} * (sketch::profile_reach(patch) + apart);
  const auto left = level_at(background, patch.position - aside),
             right = level_at(background, patch.position + aside);
  Lift result{};
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = left[c] - patch.left[c], result[c + 3] = right[c] - patch.right[c];
    if (graph::on_step(patch)) result[c] = result[c + 3] = (result[c] + result[c + 3]) / 2;
  }
  return result;
}

/// Lift in the sense of a neighbour that may run the other way.
Lift turn_lift(const Lift& lift, bool backwards) {
  if (!backwards) return lift;
  return {lift[3], lift[4], lift[5], lift[0], lift[1], lift[2]};
}

std::vector<Lift> evened(const graph::AttributeGraph& graph, std::vector<Lift> lifts) {
  for (int round = 0; round < evening; ++round) {
    const std::vector<Lift> before = lifts;
    for (std::size_t i = 0; i < graph.size(); ++i) {
      float count = 1;
      for (const auto j : graph.neighbours(i)) {
        const bool backwards = std::cos(graph.patch(i).theta - graph.patch(j).theta) < 0;
        const Lift other = turn_lift(before[j], backwards);
        for (std::size_t c = 0; c < other.size(); ++c) lifts[i][c] += other[c];
        ++count;
      }
      for (auto& value : lifts[i]) value /= count;
    }
  }
  return lifts;
}

}  // namespace

graph::AttributeGraph relight(const graph::AttributeGraph& graph, const cv::Mat& background) {
  cv::Mat smooth;
  cv::blur(background, smooth, {beside, beside}, {-1, -1}, cv::BORDER_REFLECT_101);
  std::vector<Lift> lifts;
  for (const auto& vertex : graph.vertices()) lifts.push_back(lift(vertex.patch, smooth));
  lifts = evened(graph, std::move(lifts));
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      vertices[i].patch.left[c] += lifts[i][c];
      vertices[i].patch.right[c] += lifts[i][c + 3];
      vertices[i].patch.middle[c] += (lifts[i][c] + lifts[i][c + 3]) / 2;
    }
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace emberfold::sketch
