// SPDX-License-Identifier: Apache-2.0
#include "apps/draw_graph_frames.hpp"

#include <algorithm>
#include <vector>

#include <opencv2/core.hpp>

#include "apps/interrupt.hpp"
#include "apps/stream_frames.hpp"
#include "core/clip.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

DrawnFrame draw_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                       const sketch::FillOptions& options, const Ground& ground) {
  const auto held = with_ground(part, ground);
  if (cv::countNonZero(held.mask) == 0)
    return {cv::Mat(held.levels.size(), held.levels.type(), empty), 0, true};
  const auto filled = sketch::fill(held.levels, held.mask, options);
  return {filled.levels, part.share(), filled.converged};
}

cv::Mat draw_frame(const graph::AttributeGraph& graph, const FrameLook& look) {
  const auto part = sketch::draw_fitted(graph, look.size, look.channels);
  const auto empty = cv::Scalar::all(static_cast<double>(look.empty_level));
  return core::to_bytes(draw_around(part, empty, look.fill, look.ground).levels);
}

std::vector<cv::Mat> draw_batch(std::span<const graph::AttributeGraph> graphs, const FrameLook& look,
                                const core::Context& context) {
  std::vector<cv::Mat> frames(graphs.size());
  const auto status = core::parallel_for(graphs.size(), context,
                                         [&](std::size_t i) { frames[i] = draw_frame(graphs[i], look); });
  if (status == core::Status::cancelled) throw Interrupted{};
  return frames;
}

void draw_frames(int count, const FrameLook& look, std::string_view stage, const core::Context& context,
                 const std::function<graph::AttributeGraph(int)>& graph,
                 const std::function<void(int, const cv::Mat&)>& take) {
  const auto most = static_cast<int>(frames_at_once(look.size.width, look.size.height, look.channels));
  context.report(stage, 0);
  for (int first = 0; first < count; first += most) {
    std::vector<graph::AttributeGraph> graphs;
    for (int t = first; t < std::min(count, first + most); ++t) {
      if (context.cancelled()) throw Interrupted{};
      graphs.push_back(graph(t));
    }
    const auto frames = draw_batch(graphs, look, context);
    for (std::size_t i = 0; i < frames.size(); ++i) take(first + static_cast<int>(i), frames[i]);
    context.report(stage, static_cast<double>(first + static_cast<int>(frames.size())) / count);
  }
}

}  // namespace emberfold::apps
