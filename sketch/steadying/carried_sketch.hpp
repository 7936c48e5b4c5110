// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds the sketch of a neighbouring frame, carried along by the motion to the places of this frame.
struct CarriedSketch {
  graph::AttributeGraph graph;
  cv::Mat1f difference;  ///< grey levels, local RMS: this frame from the neighbour, carried likewise
};

/// Returns the motion at a place of a frame of `size` px. `motion`: CV_32FC2, px; it may be smaller than the
/// frame, and is interpolated bilinearly.
graph::Point sample_motion(const cv::Mat& motion, cv::Size size, graph::Point p);

/// Moves every patch of a sketch by the motion at its place. `motion`: CV_32FC2, px, of a frame of `size` px;
/// it may be smaller than the frame. O(patches).
graph::AttributeGraph carry_sketch(const graph::AttributeGraph& graph, const cv::Mat& motion, cv::Size size);

/// Measures how a frame differs from another, from which `motion` (as above) leads there: the local RMS over
/// 3 px. Both CV_32F, 1 channel. O(pixels).
cv::Mat1f measure_difference(const cv::Mat1f& luma, const cv::Mat1f& other, const cv::Mat& motion);

}  // namespace emberfold::sketch
