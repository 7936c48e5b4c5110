// SPDX-License-Identifier: Apache-2.0
#include "apps/draw_graph_frames.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/interrupt.hpp"
#include "core/clip.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {
constexpr double joint_reach = 8;  // px within which a ground takes the strokes' levels

constexpr int coarse = 4;  // of the fill that patches fade into: a cell is so many px
constexpr float there = 0.999F;

template <class Change>
graph::AttributeGraph changed(const graph::AttributeGraph& graph, const Change& change) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < vertices.size(); ++i) change(i, vertices[i].patch);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

/// What would be there without the patches that are not quite there, in coarse cells: good enough for levels
/// to begin from.
cv::Mat without_fading(const sketch::Sketchable& part, const cv::Mat& presence, const FrameLook& look) {
  const auto held = with_ground({part.levels, part.mask & (presence >= there)}, look.ground);
  const cv::Size size = held.mask.size();
  const auto cells = [](int length) { return (length + coarse - 1) / coarse; };
  cv::Mat weight, weights, levels, seen;
  held.mask.convertTo(weight, CV_32F, 1 / 255.0);
  cv::resize(weight, weight, {cells(size.width), cells(size.height)}, 0, 0, cv::INTER_AREA);
  held.levels.copyTo(seen, held.mask);
  cv::resize(seen, levels, weight.size(), 0, 0, cv::INTER_AREA);
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(levels.channels()), cv::max(weight, 1e-3)),
            weights);
  levels /= weights;
  const cv::Mat known = weight > 0.05;
  if (cv::countNonZero(known) == 0)
    return {size, levels.type(), cv::Scalar::all(static_cast<double>(look.empty_level))};
  cv::Mat whole;
  cv::resize(sketch::fill(levels, known, look.fill).levels, whole, size, 0, 0, cv::INTER_LINEAR);
  return whole;
}

/// A line's core gets farther from its sides, a step's sides from each other.
void raise_contrast(graph::Patch& patch, float gain) {
  for (std::size_t c = 0; c < patch.middle.size(); ++c) {
    const float mean = (patch.left[c] + patch.right[c]) / 2;
    for (auto* level : {&patch.left, &patch.right, &patch.middle})
      if (graph::on_step(patch) != (level == &patch.middle)) (*level)[c] = mean + gain * ((*level)[c] - mean);
  }
}

/// The strokes of a frame; those that come and go are drawn between `ground` (or what the others leave there)
/// and themselves.
sketch::Sketchable draw_strokes(const FrameParts& parts, const FrameLook& look, const cv::Mat& ground) {
  const bool as_fitted = look.blur_share == 1 && look.contrast_gain == 1;
  const auto graph = as_fitted ? parts.graph : changed(parts.graph, [&](std::size_t, graph::Patch& patch) {
    patch.blur *= look.blur_share;
    raise_contrast(patch, static_cast<float>(look.contrast_gain));
  });
  auto part = sketch::draw_fitted(graph, look.size, look.channels);
  if (std::ranges::all_of(parts.presence, [](float share) { return share >= there; })) return part;
  const auto shares = changed(graph, [&](std::size_t i, graph::Patch& patch) {
    patch.left.fill(parts.presence[i]), patch.middle = patch.right = patch.left;
  });
  const cv::Mat presence = sketch::draw_fitted(shares, look.size, 1).levels;
  const cv::Mat from = ground.empty() ? without_fading(part, presence, look) : ground;
  const int channels = look.channels;
  for (int y = 0; y < look.size.height; ++y) {
    const auto* mask = part.mask.ptr(y);
    const auto *share = presence.ptr<float>(y), *begin = from.ptr<float>(y);
    auto* levels = part.levels.ptr<float>(y);
    for (int x = 0; x < look.size.width; ++x)
      for (int c = x * channels; mask[x] != 0 && share[x] < there && c < (x + 1) * channels; ++c)
        levels[c] = begin[c] + share[x] * (levels[c] - begin[c]);
  }
  return part;
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
  cv::Mat ground;
  if (!parts.ground.empty()) parts.ground.convertTo(ground, CV_32F);
  const auto part = draw_strokes(parts, look, ground);
  if (!ground.empty())
    return core::to_bytes(sketch::fill_onto(part.levels, part.mask, ground, joint_reach, look.fill).levels);
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
  for (const auto& graph : graphs) parts.push_back({graph});
  return draw_batch(parts, look, context);
}

}  // namespace emberfold::apps
