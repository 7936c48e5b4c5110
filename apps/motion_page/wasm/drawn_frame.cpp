// SPDX-License-Identifier: Apache-2.0
#include "apps/motion_page/wasm/drawn_frame.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sketch/background/patch_distance.hpp"
#include "sketch/rendering/draw_patches.hpp"
#include "sketch/rendering/patch_contrast.hpp"

namespace emberfold::apps {

namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
}

// Adjusts patches as FrameRenderer does for those of a model at new places.
graph::AttributeGraph adjust(const graph::AttributeGraph& graph, const PageLook& look) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (auto& vertex : vertices) {
    vertex.patch.blur *= look.blur_share;
    sketch::raise_contrast(vertex.patch, static_cast<float>(look.contrast_gain));
  }
  const graph::AttributeGraph sharp(std::move(vertices), {graph.edges().begin(), graph.edges().end()});
  if (look.range_low.empty()) return sharp;
  return sketch::clamp_levels(sharp, {look.range_columns, look.range_rows, look.range_channels,
                                      look.range_low.data(), look.range_high.data()});
}

}  // namespace

DrawnFrames::DrawnFrames(const mcmc::MotionModel& model, const PageLook& look, std::uint64_t seed)
    : look_(look), size_(model.width, model.height), strokes_(model, seed) {}

void DrawnFrames::next() {
  if (begun_) ahead_.pop_front();
  begun_ = true;
  while (ahead_.size() <= sketch::FadeInOut::kAhead) {
    graph::AttributeGraph graph = strokes_.next();
    ahead_.push_back({std::move(graph), strokes_.operators()});
  }
  std::vector<const graph::AttributeGraph*> coming;
  for (std::size_t i = 1; i < ahead_.size(); ++i) coming.push_back(&ahead_[i].graph);
  draw(fader_.next(ahead_.front().graph, coming));
}

void DrawnFrames::draw(const sketch::FadedGraph& faded) {
  const std::size_t count = static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
  const auto channels = static_cast<std::size_t>(look_.channels);
  std::vector<float> levels(count * channels), weights(count), values(2 * count), opacity(count), distance;
  std::vector<std::uint8_t> mask(count);
  std::vector<std::array<float, 2>> shares;
  for (const float share : faded.opacity) shares.push_back({share, 0});
  sketch::draw_patches(adjust(faded.graph, look_), shares,
                       {size_, look_.channels, levels.data(), weights.data(), mask.data(), values.data()});
  for (std::size_t i = 0; i < count; ++i) opacity[i] = values[2 * i];
  if (!look_.still.empty()) {
    distance.resize(count);
    sketch::distance_from_patches(size_, mask.data(), opacity.data(), distance.data());
  }
  pixels_.assign(4 * count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const bool fixed = !look_.fixed.empty() && look_.fixed[i] != 0;
    const bool still = fixed || (!look_.still.empty() && look_.still[i] != 0 && mask[i] == 0 &&
                                 distance[i] > sketch::kBackgroundDistance);
    if (!still && mask[i] == 0) continue;
    const float* from = (still ? look_.still_levels.data() : levels.data()) + i * channels;
    for (std::size_t c = 0; c < 3; ++c) pixels_[4 * i + c] = to_byte(from[channels == 3 ? 2 - c : 0]);
    pixels_[4 * i + 3] = still ? 255 : std::max(to_byte(255 * opacity[i]), std::uint8_t{1});
  }
}

}  // namespace emberfold::apps
