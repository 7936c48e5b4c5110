// SPDX-License-Identifier: Apache-2.0
#include "apps/draw_graph_frames.hpp"

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "apps/interrupt.hpp"
#include "core/clip.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {
constexpr double joint_reach = 8;  // px within which a ground takes the strokes' levels

graph::AttributeGraph sharpened(const graph::AttributeGraph& graph, double share) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (auto& vertex : vertices) vertex.patch.blur *= share;
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

sketch::Sketchable draw_strokes(const graph::AttributeGraph& graph, const FrameLook& look) {
  if (look.blur_share == 1) return sketch::draw_fitted(graph, look.size, look.channels);
  return sketch::draw_fitted(sharpened(graph, look.blur_share), look.size, look.channels);
}
}  // namespace

DrawnFrame draw_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                       const sketch::FillOptions& options, const Ground& ground) {
  const auto held = with_ground(part, ground);
  if (cv::countNonZero(held.mask) == 0)
    return {cv::Mat(held.levels.size(), held.levels.type(), empty), 0, true};
  const auto filled = sketch::fill(held.levels, held.mask, options);
  return {filled.levels, part.share(), filled.converged};
}

cv::Mat draw_frame(const FrameParts& parts, const FrameLook& look) {
  const auto part = draw_strokes(parts.graph, look);
  if (!parts.ground.empty()) {
    cv::Mat ground;
    parts.ground.convertTo(ground, CV_32F);
    return core::to_bytes(sketch::fill_onto(part.levels, part.mask, ground, joint_reach, look.fill).levels);
  }
  const auto empty = cv::Scalar::all(static_cast<double>(look.empty_level));
  return core::to_bytes(draw_around(part, empty, look.fill, look.ground).levels);
}

std::vector<cv::Mat> draw_batch(std::span<const FrameParts> parts, const FrameLook& look,
                                const core::Context& context) {
  std::vector<cv::Mat> frames(parts.size());
  const auto status = core::parallel_for(parts.size(), context,
                                         [&](std::size_t i) { frames[i] = draw_frame(parts[i], look); });
  if (status == core::Status::cancelled) throw Interrupted{};
  return frames;
}

std::vector<cv::Mat> draw_batch(std::span<const graph::AttributeGraph> graphs, const FrameLook& look,
                                const core::Context& context) {
  std::vector<FrameParts> parts;
  for (const auto& graph : graphs) parts.push_back({graph, {}});
  return draw_batch(parts, look, context);
}

}  // namespace emberfold::apps
