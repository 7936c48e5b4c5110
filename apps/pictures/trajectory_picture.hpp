// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::apps {

/// Draws the strokes of a clip over time (Wang & Zhu 2004, Figs. 7 and 8), CV_8UC3, 1400 px wide.
/// On the left the curves of up to 24 long-lived, moving strokes in space and time: x is depth, y down, time
/// to the right. On the right the centres of up to 100 strokes, x and y against time. Each stroke has one
/// colour; marks show its events of probability 0.5 or more. `events`: ordered by frame.
cv::Mat draw_trajectories(const graph::MotionGraph& motion, std::span<const graph::Event> events);

}  // namespace emberfold::apps
