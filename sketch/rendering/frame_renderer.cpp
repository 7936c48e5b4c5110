// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/frame_renderer.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"
#include "sketch/rendering/fade_levels.hpp"
#include "sketch/rendering/relight.hpp"

namespace emberfold::sketch {

namespace {
constexpr double joint_reach = 8;  // px within which a ground takes the strokes' levels

constexpr double detail_scale = 4;  // px, SD: what is finer in a ground goes on through lines

template <class Change>
graph::AttributeGraph changed(const graph::AttributeGraph& graph, const Change& change) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < vertices.size(); ++i) change(i, vertices[i].patch);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

/// A line's core gets farther from its sides, a step's sides from each other.
void raise_contrast(graph::Patch& patch, float gain) {
  for (std::size_t c = 0; c < patch.middle.size(); ++c) {
    const float mean = (patch.left[c] + patch.right[c]) / 2;
    for (auto* level : {&patch.left, &patch.right, &patch.middle})
      if (graph::on_step(patch) != (level == &patch.middle)) (*level)[c] = mean + gain * ((*level)[c] - mean);
    if (patch.hollow > 0) patch.between[c] = mean + gain * (patch.between[c] - mean);
  }
}

/// What is drawn of a frame's strokes, and how much of them there is.
struct DrawnStrokes {
  sketch::Sketchable part;
  cv::Mat presence;  ///< CV_32F, 0…1; empty: all is there
};

graph::AttributeGraph as_drawn(const FrameContent& parts, const RenderOptions& look, const cv::Mat& ground) {
  const bool as_fitted = look.blur_share == 1 && look.contrast_gain == 1;
  const auto sharp = as_fitted ? parts.graph : changed(parts.graph, [&](std::size_t, graph::Patch& patch) {
    patch.blur *= look.blur_share;
    raise_contrast(patch, static_cast<float>(look.contrast_gain));
  });
  if (!look.new_places) return sharp;
  return clamp_levels(ground.empty() ? sharp : relight(sharp, ground), look.ground.seen);
}

/// Lets the ground's detail go on through lines: what a profile tells of them is a mean along the crease.
void lay_detail(cv::Mat& levels, const cv::Mat& ground, const cv::Mat& lines) {
  cv::Mat smooth, detail, shares;
  cv::GaussianBlur(ground, smooth, {}, detail_scale);
  detail = ground - smooth;
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(levels.channels()), lines), shares);
  levels += detail.mul(shares);
}

/// The strokes of a frame; those that come and go are drawn between `ground` (or what would be there without
/// them) and themselves.
DrawnStrokes draw_strokes(const FrameContent& parts, const RenderOptions& look, const BackgroundImage& still,
                          const cv::Mat& ground) {
  const bool detailed = look.new_places && !ground.empty();
  const auto graph = as_drawn(parts, look, ground);
  const bool all_there = std::ranges::all_of(parts.presence, [](float share) { return share >= kOpaque; });
  const auto behind_backdrop = [&](sketch::Sketchable drawn) {
    if (!still.fixed.empty()) drawn.mask.setTo(0, still.fixed);
    return drawn;
  };
  if ((all_there && !detailed) || graph.size() == 0)
    return {behind_backdrop(sketch::draw_fitted(graph, look.size, look.channels)), {}};
  std::vector<std::array<float, 2>> shares;  // presence, share of lines
  for (std::size_t i = 0; i < graph.size(); ++i)
    shares.push_back(
        {parts.presence.empty() ? 1 : parts.presence[i], graph::on_step(graph.patch(i)) ? 0.0F : 1.0F});
  auto [whole, told] = sketch::draw_fitted(graph, look.size, look.channels, shares);
  sketch::Sketchable part = behind_backdrop(std::move(whole));
  std::array<cv::Mat, 2> drawn;
  cv::split(told, drawn.data());
  const auto& [presence, lines] = drawn;
  if (detailed) lay_detail(part.levels, ground, lines);
  if (all_there) return {std::move(part), {}};
  if (ground.empty())
    blend_with_fill(part, presence, still, look.empty_level, look.fill);
  else
    blend_with_background(part, presence, ground);
  return {std::move(part), presence};
}
}  // namespace

RenderedLevels render_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                             const sketch::FillOptions& options, const BackgroundImage& ground,
                             const cv::Mat& presence) {
  const auto held = add_background_pixels(part, ground, presence);
  if (cv::countNonZero(held.mask) == 0)
    return {cv::Mat(held.levels.size(), held.levels.type(), empty), 0, true};
  const auto filled = sketch::fill(held.levels, held.mask, options);
  return {filled.levels, part.share(), filled.converged};
}

graph::AttributeGraph visible_patches(const FrameContent& parts) {
  if (parts.presence.empty()) return parts.graph;
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const auto is_there = [&](std::size_t i) { return parts.presence[i] >= 0.5F; };
  for (std::size_t i = 0; i < parts.graph.size(); ++i)
    if (is_there(i)) vertices.push_back(parts.graph.vertices()[i]);
  for (const auto& edge : parts.graph.edges())
    if (is_there(parts.graph.index_of(edge.a)) && is_there(parts.graph.index_of(edge.b)))
      edges.push_back(edge);
  return {std::move(vertices), std::move(edges)};
}

FrameRenderer::FrameRenderer(const RenderOptions& look)
    : look_(look), still_(background_image(look.ground, look.size, look.channels)) {}

cv::Mat FrameRenderer::draw(const FrameContent& parts) const {
  cv::Mat ground;
  if (!parts.ground.empty()) parts.ground.convertTo(ground, CV_32F);
  const auto [part, presence] = draw_strokes(parts, look_, still_, ground);
  if (!ground.empty())
    return core::to_bytes(sketch::fill_onto(part.levels, part.mask, ground, joint_reach, look_.fill).levels);
  const auto empty = cv::Scalar::all(static_cast<double>(look_.empty_level));
  cv::Mat levels = render_around(part, empty, look_.fill, still_, presence).levels;
  if (!parts.residual.empty()) cv::add(levels, parts.residual, levels, cv::noArray(), CV_32F);
  paste_static_pixels(levels, still_);
  return core::to_bytes(levels);
}

std::vector<cv::Mat> render_frames(std::span<const FrameContent> parts, const RenderOptions& look,
                                   const core::Context& context) {
  std::vector<cv::Mat> frames(parts.size());
  const FrameRenderer painter(look);
  core::parallel_for(parts.size(), context, [&](std::size_t i) { frames[i] = painter.draw(parts[i]); });
  return frames;
}

std::vector<cv::Mat> render_frames(std::span<const graph::AttributeGraph> graphs, const RenderOptions& look,
                                   const core::Context& context) {
  std::vector<FrameContent> parts;
  for (const auto& graph : graphs) parts.push_back({graph});
  return render_frames(parts, look, context);
}

}  // namespace emberfold::sketch
