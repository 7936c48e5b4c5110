// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/ground.hpp"
#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/fill.hpp"
#include "sketch/render.hpp"

namespace emberfold::apps {

/// A frame of which patches show a part and diffusion the rest.
struct DrawnFrame {
  cv::Mat levels;    ///< CV_32F, white = 255
  double share = 0;  ///< that patches show, 0…1
  bool converged = true;
};

/// Fills what `part` and the still ground leave open; with nothing held the frame becomes `empty`, levels by
/// channel.
DrawnFrame draw_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                       const sketch::FillOptions& options, const Ground& ground = {});

/// What the frames of a clip of graphs have in common.
struct FrameLook {
  cv::Size size;
  int channels = 3;       ///< 1 or 3
  float empty_level = 0;  ///< of a frame without patches and ground, white = 255
  sketch::FillOptions fill = {};
  Ground ground = {};
};

/// The frame that a graph alone tells of: patches drawn from their attributes, the still ground away from
/// them, the rest filled. CV_8U.
cv::Mat draw_frame(const graph::AttributeGraph& graph, const FrameLook& look);

/// Draws the frames of these graphs on several threads, CV_8U. Throws Interrupted.
std::vector<cv::Mat> draw_batch(std::span<const graph::AttributeGraph> graphs, const FrameLook& look,
                                const core::Context& context);

/// Draws `count` frames: graph(t) is asked for one after the other, the frames are drawn on several threads,
/// take(t, frame) gets them in order (CV_8U). Holds a batch, some 16 frames or 192 MB, whichever is less.
/// Throws Interrupted.
void draw_frames(int count, const FrameLook& look, std::string_view stage, const core::Context& context,
                 const std::function<graph::AttributeGraph(int)>& graph,
                 const std::function<void(int, const cv::Mat&)>& take);

}  // namespace emberfold::apps
