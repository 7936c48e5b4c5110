// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::apps {

/// Returns the frames t with most events between t − 1 and t, ascending: at most `count`, no two adjacent; of
/// ties the earlier.
std::vector<int> eventful_gaps(std::span<const graph::Event> events, std::size_t count);

/// Holds for each vertex of frames t − 1 and t the number of its cluster of linked strokes, from 1 in order
/// of appearance in t − 1; 0 for a stroke without links.
struct GapClusters {
  std::vector<std::uint32_t> before, after;
};
/// Finds the clusters of strokes joined by links between frames t − 1 and t.
GapClusters gap_clusters(const graph::MotionGraph& motion, int t);

/// Draws frames t − 1 and t (CV_8UC3) side by side with their graphs. Matched strokes share a colour, others
/// are white; the events of t are marked on both (Wang & Zhu 2004, Figs. 9, 11, 14).
cv::Mat draw_match(const cv::Mat& before, const cv::Mat& after, const graph::MotionGraph& motion, int t,
                   std::span<const graph::Event> events);

}  // namespace emberfold::apps
