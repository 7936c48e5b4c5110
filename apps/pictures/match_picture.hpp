// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::apps {

/// The frames t whose gap from t − 1 holds most events, at most `count` of them and no two neighbours; of
/// equals the earlier. Ascending.
std::vector<int> eventful_gaps(std::span<const graph::Event> events, std::size_t count);

/// For each vertex of frames t − 1 and t the number of the cluster of strokes that the links of this gap tie
/// together, counted from 1 in order of appearance in t − 1; 0 where a stroke has no link: it ends or begins
/// here.
struct GapClusters {
  std::vector<std::uint32_t> before, after;
};
GapClusters gap_clusters(const graph::MotionGraph& motion, int t);

/// Frames t − 1 and t (CV_8UC3) side by side, each with its graph: strokes that are matched have one colour,
/// those that are not are white; the events of t are marked on both (Wang & Zhu 2004, Figs. 9, 11, 14).
cv::Mat draw_match(const cv::Mat& before, const cv::Mat& after, const graph::MotionGraph& motion, int t,
                   std::span<const graph::Event> events);

}  // namespace emberfold::apps
