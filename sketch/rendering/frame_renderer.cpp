// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/frame_renderer.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"
#include "sketch/background/level_range.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/fade_levels.hpp"
#include "sketch/rendering/patch_contrast.hpp"

namespace emberfold::sketch {

namespace {

template <class Change>
graph::AttributeGraph transform_patches(const graph::AttributeGraph& graph, const Change& change) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < vertices.size(); ++i) change(i, vertices[i].patch);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

/// Drawn strokes of a frame, with their opacity.
struct DrawnStrokes {
  sketch::Sketchable part;
  cv::Mat opacity;  ///< CV_32F, 0…1; empty: all opaque
};

graph::AttributeGraph adjust_patches(const FrameContent& content, const RenderOptions& options) {
  const bool as_fitted = options.blur_share == 1 && options.contrast_gain == 1;
  auto sharp =
      as_fitted ? content.graph : transform_patches(content.graph, [&](std::size_t, graph::Patch& patch) {
        patch.blur *= options.blur_share;
        raise_contrast(patch, static_cast<float>(options.contrast_gain));
      });
  if (!options.new_places) return sharp;
  const auto placed = clamp_levels(sharp, options.background.level_range);
  return transform_patches(placed, [&](std::size_t i, graph::Patch& patch) {
    if (graph::is_anchor(patch)) patch = content.graph.patch(i);
  });
}

/// The strokes of a frame; those that come and go are drawn between what would be there without them and
/// themselves.
DrawnStrokes draw_strokes(const FrameContent& content, const RenderOptions& options,
                          const BackgroundImage& still) {
  const auto graph = adjust_patches(content, options);
  const bool all_there = std::ranges::all_of(content.opacity, [](float share) { return share >= kOpaque; });
  const auto behind_backdrop = [&](sketch::Sketchable drawn) {
    if (!still.fixed.empty()) drawn.mask.setTo(0, still.fixed);
    return drawn;
  };
  if (all_there || graph.size() == 0)
    return {behind_backdrop(sketch::draw_fitted(graph, options.size, options.channels)), {}};
  auto [whole, opacity] = sketch::draw_fitted(graph, options.size, options.channels, content.opacity);
  sketch::Sketchable part = behind_backdrop(std::move(whole));
  blend_with_fill(part, opacity, still, options.empty_level);
  return {std::move(part), std::move(opacity)};
}
}  // namespace

RenderedLevels render_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                             const BackgroundImage& background, const cv::Mat& opacity) {
  const auto held = add_background_pixels(part, background, opacity);
  if (cv::countNonZero(held.mask) == 0)
    return {cv::Mat(held.levels.size(), held.levels.type(), empty), 0, true};
  const auto filled = sketch::fill(held.levels, held.mask);
  return {filled.levels, part.share(), filled.converged};
}

graph::AttributeGraph visible_patches(const FrameContent& content) {
  if (content.opacity.empty()) return content.graph;
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const auto is_there = [&](std::size_t i) { return content.opacity[i] >= 0.5F; };
  for (std::size_t i = 0; i < content.graph.size(); ++i)
    if (is_there(i)) vertices.push_back(content.graph.vertices()[i]);
  for (const auto& edge : content.graph.edges())
    if (is_there(content.graph.index_of(edge.a)) && is_there(content.graph.index_of(edge.b)))
      edges.push_back(edge);
  return {std::move(vertices), std::move(edges)};
}

FrameRenderer::FrameRenderer(const RenderOptions& options)
    : options_(options), still_(expand_background(options.background, options.size, options.channels)) {}

cv::Mat FrameRenderer::draw(const FrameContent& content) const {
  const auto [part, opacity] = draw_strokes(content, options_, still_);
  const auto empty = cv::Scalar::all(static_cast<double>(options_.empty_level));
  cv::Mat levels = render_around(part, empty, still_, opacity).levels;
  paste_static_pixels(levels, still_);
  return core::to_bytes(levels);
}

std::vector<cv::Mat> render_frames(std::span<const FrameContent> content, const RenderOptions& options,
                                   const core::Context& context) {
  std::vector<cv::Mat> frames(content.size());
  const FrameRenderer painter(options);
  core::parallel_for(content.size(), context, [&](std::size_t i) { frames[i] = painter.draw(content[i]); });
  return frames;
}

std::vector<cv::Mat> render_frames(std::span<const graph::AttributeGraph> graphs,
                                   const RenderOptions& options, const core::Context& context) {
  std::vector<FrameContent> content;
  for (const auto& graph : graphs) content.push_back({graph});
  return render_frames(content, options, context);
}

}  // namespace emberfold::sketch
