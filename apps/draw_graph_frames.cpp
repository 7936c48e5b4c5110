// SPDX-License-Identifier: Apache-2.0
#include "apps/draw_graph_frames.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/interrupt.hpp"
#include "apps/rest_on_ground.hpp"
#include "core/clip.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {
constexpr double joint_reach = 8;  // px within which a ground takes the strokes' levels

constexpr int coarse = 4;  // of the fill that patches fade into: a cell is so many px
constexpr float there = 0.999F;
constexpr int fade_steps = 6;       // a fade's, as fading.hpp has it
constexpr double detail_scale = 4;  // px, SD: what is finer in a ground goes on through lines

template <class Change>
graph::AttributeGraph changed(const graph::AttributeGraph& graph, const Change& change) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < vertices.size(); ++i) change(i, vertices[i].patch);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

/// The fill of these patches in coarse cells: good enough for levels to begin from.
cv::Mat fill_coarsely(const sketch::Sketchable& part, const FrameLook& look) {
  const auto held = with_ground(part, look.ground);
  const auto cells = [](int length) { return (length + coarse - 1) / coarse; };
  cv::Mat weight, weights, levels, seen;
  held.mask.convertTo(weight, CV_32F, 1 / 255.0);
  cv::resize(weight, weight, {cells(held.mask.cols), cells(held.mask.rows)}, 0, 0, cv::INTER_AREA);
  held.levels.copyTo(seen, held.mask);
  cv::resize(seen, levels, weight.size(), 0, 0, cv::INTER_AREA);
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(levels.channels()), cv::max(weight, 1e-3)),
            weights);
  levels /= weights;
  const cv::Mat known = weight > 0.05;
  if (cv::countNonZero(known) == 0)
    return {levels.size(), levels.type(), cv::Scalar::all(static_cast<double>(look.empty_level))};
  return sketch::fill(levels, known, look.fill).levels;
}

/// What the patches that are not quite there show. The frame's smooth part is the mean, over all shares s, of
/// the fill of those patches of which at least s is there: so a stroke that begins to fade tells on all
/// others by as little as on itself. To it comes what each patch's own levels have beyond it, by its share.
void fade(sketch::Sketchable& part, const cv::Mat& presence, const FrameLook& look) {
  const cv::Mat all = fill_coarsely(part, look);
  cv::Mat sum = cv::Mat::zeros(all.size(), all.type()), mask = part.mask, level = all;
  for (int k = 0; k <= fade_steps; ++k) {  // between the shares that a fade goes through
    const float share = k < fade_steps ? (static_cast<float>(k) + 0.5F) / fade_steps : 1;
    const cv::Mat left = part.mask & (presence >= share - (1 - there));
    if (cv::norm(left, mask, cv::NORM_INF) != 0) level = fill_coarsely({part.levels, left}, look);
    mask = left;
    sum += level * (k == 0 || k == fade_steps ? 0.5 / fade_steps : 1.0 / fade_steps);
  }
  cv::Mat from, whole;
  cv::resize(sum, from, part.mask.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(all, whole, part.mask.size(), 0, 0, cv::INTER_LINEAR);
  const int channels = part.levels.channels();
  for (int y = 0; y < part.mask.rows; ++y) {
    const auto* drawn = part.mask.ptr(y);
    const auto *share = presence.ptr<float>(y), *begin = from.ptr<float>(y), *own = whole.ptr<float>(y);
    auto* levels = part.levels.ptr<float>(y);
    for (int x = 0; x < part.mask.cols; ++x)
      for (int c = x * channels; drawn[x] != 0 && share[x] < there && c < (x + 1) * channels; ++c)
        levels[c] = begin[c] + share[x] * (levels[c] - own[c]);
  }
}

/// The same on a ground, which is what is there without them.
void fade_onto(sketch::Sketchable& part, const cv::Mat& presence, const cv::Mat& ground) {
  const int channels = part.levels.channels();
  for (int y = 0; y < part.mask.rows; ++y) {
    const auto* drawn = part.mask.ptr(y);
    const auto *share = presence.ptr<float>(y), *begin = ground.ptr<float>(y);
    auto* levels = part.levels.ptr<float>(y);
    for (int x = 0; x < part.mask.cols; ++x)
      for (int c = x * channels; drawn[x] != 0 && share[x] < there && c < (x + 1) * channels; ++c)
        levels[c] = begin[c] + share[x] * (levels[c] - begin[c]);
  }
}

/// A line's core gets farther from its sides, a step's sides from each other.
void raise_contrast(graph::Patch& patch, float gain) {
  for (std::size_t c = 0; c < patch.middle.size(); ++c) {
    const float mean = (patch.left[c] + patch.right[c]) / 2;
    for (auto* level : {&patch.left, &patch.right, &patch.middle})
      if (graph::on_step(patch) != (level == &patch.middle)) (*level)[c] = mean + gain * ((*level)[c] - mean);
  }
}

/// What is drawn of a frame's strokes, and how much of them there is.
struct DrawnStrokes {
  sketch::Sketchable part;
  cv::Mat presence;  ///< CV_32F, 0…1; empty: all is there
};

graph::AttributeGraph as_drawn(const FrameParts& parts, const FrameLook& look, const cv::Mat& ground) {
  const bool as_fitted = look.blur_share == 1 && look.contrast_gain == 1;
  const auto sharp = as_fitted ? parts.graph : changed(parts.graph, [&](std::size_t, graph::Patch& patch) {
    patch.blur *= look.blur_share;
    raise_contrast(patch, static_cast<float>(look.contrast_gain));
  });
  if (!look.new_places) return sharp;
  return within(ground.empty() ? sharp : rest_on(sharp, ground), look.ground.seen);
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
DrawnStrokes draw_strokes(const FrameParts& parts, const FrameLook& look, const cv::Mat& ground) {
  const bool detailed = look.new_places && !ground.empty();
  const auto graph = as_drawn(parts, look, ground);
  auto part = sketch::draw_fitted(graph, look.size, look.channels);
  const bool all_there = std::ranges::all_of(parts.presence, [](float share) { return share >= there; });
  if (all_there && !detailed) return {std::move(part), {}};
  const auto shares = changed(graph, [&](std::size_t i, graph::Patch& patch) {
    patch.left = {parts.presence.empty() ? 1 : parts.presence[i], graph::on_step(patch) ? 0.0F : 1.0F, 0};
    patch.middle = patch.right = patch.left;
  });
  std::array<cv::Mat, 3> drawn;  // presence, share of lines
  cv::split(sketch::draw_fitted(shares, look.size, 3).levels, drawn.data());
  const cv::Mat& presence = drawn[0];
  if (detailed) lay_detail(part.levels, ground, drawn[1]);
  if (all_there) return {std::move(part), {}};
  if (ground.empty())
    fade(part, presence, look);
  else
    fade_onto(part, presence, ground);
  return {std::move(part), presence};
}
}  // namespace

DrawnFrame draw_around(const sketch::Sketchable& part, const cv::Scalar& empty,
                       const sketch::FillOptions& options, const Ground& ground, const cv::Mat& presence) {
  const auto held = with_ground(part, ground, presence);
  if (cv::countNonZero(held.mask) == 0)
    return {cv::Mat(held.levels.size(), held.levels.type(), empty), 0, true};
  const auto filled = sketch::fill(held.levels, held.mask, options);
  return {filled.levels, part.share(), filled.converged};
}

graph::AttributeGraph mostly_there(const FrameParts& parts) {
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

cv::Mat draw_frame(const FrameParts& parts, const FrameLook& look) {
  cv::Mat ground;
  if (!parts.ground.empty()) parts.ground.convertTo(ground, CV_32F);
  auto [part, presence] = draw_strokes(parts, look, ground);
  if (!ground.empty() && !look.ground.backdrop.empty()) part.mask.setTo(0, look.ground.backdrop.still);
  if (!ground.empty())
    return core::to_bytes(sketch::fill_onto(part.levels, part.mask, ground, joint_reach, look.fill).levels);
  const auto empty = cv::Scalar::all(static_cast<double>(look.empty_level));
  return core::to_bytes(draw_around(part, empty, look.fill, look.ground, presence).levels);
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
