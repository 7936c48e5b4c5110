// SPDX-License-Identifier: Apache-2.0
#include "apps/draw_graph_frames.hpp"

#include <vector>

#include <opencv2/core.hpp>

#include "apps/interrupt.hpp"
#include "core/clip.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {
constexpr double joint_reach = 8;  // px within which a ground takes the strokes' levels
}

DrawnFrame draw_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                       const sketch::FillOptions& options, const Ground& ground) {
  const auto held = with_ground(part, ground);
  if (cv::countNonZero(held.mask) == 0)
    return {cv::Mat(held.levels.size(), held.levels.type(), empty), 0, true};
  const auto filled = sketch::fill(held.levels, held.mask, options);
  return {filled.levels, part.share(), filled.converged};
}

cv::Mat draw_frame(const FrameParts& parts, const FrameLook& look) {
  const auto part = sketch::draw_fitted(parts.graph, look.size, look.channels);
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
