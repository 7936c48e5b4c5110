// SPDX-License-Identifier: Apache-2.0
#include "pipeline/frame_synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"
#include "graph/events/events.hpp"

namespace emberfold::pipeline {

namespace {

bool is_grey(const graph::AttributeGraph& graph) {
  const auto same = [](const graph::Level& l) { return l[0] == l[1] && l[1] == l[2]; };
  return std::ranges::all_of(graph.vertices(), [&](const graph::Vertex& v) {
    return same(v.patch.left) && same(v.patch.middle) && same(v.patch.right);
  });
}

}  // namespace

sketch::RenderOptions render_options(const mcmc::MotionModel& model, sketch::Background ground) {
  sketch::RenderOptions look{{model.width, model.height}, std::max(1, ground.levels.channels())};
  look.background = std::move(ground);
  double sum = 0, count = 0;
  const auto look_at = [&](const graph::AttributeGraph& graph) {
    if (!is_grey(graph)) look.channels = 3;
    for (const auto& vertex : graph.vertices())
      for (const auto* side : {&vertex.patch.left, &vertex.patch.right}) {
        sum += 0.114 * double{(*side)[0]} + 0.587 * double{(*side)[1]} + 0.299 * double{(*side)[2]};
        ++count;
      }
  };
  look_at(model.first);
  for (const auto& exemplar : model.exemplars) look_at(exemplar.graph);
  if (count > 0) look.empty_level = static_cast<float>(sum / count);
  return look;
}

FrameSynthesis::FrameSynthesis(mcmc::Synthesis strokes, sketch::RenderOptions look)
    : strokes_(std::move(strokes)), look_(std::move(look)) {
  look_.new_places = true;
}

int FrameSynthesis::batch() const {
  return static_cast<int>(core::frames_at_once(look_.size.width, look_.size.height, look_.channels));
}

/// Returns the next frame's graph, followed by those of later frames.
FrameSynthesis::Drawn FrameSynthesis::take() {
  while (ahead_.size() <= sketch::FadeInOut::kAhead) {
    Drawn drawn{strokes_.next(), {}};
    drawn.operators = strokes_.operators();
    ahead_.push_back(std::move(drawn));
  }
  Drawn drawn = std::move(ahead_.front());
  ahead_.pop_front();
  return drawn;
}

sketch::FrameContent FrameSynthesis::next_parts() {
  Drawn drawn = take();
  statistics_.add(drawn.graph, drawn.operators);
  std::vector<const graph::AttributeGraph*> coming;
  for (const auto& later : ahead_) coming.push_back(&later.graph);
  auto fading = fader_.next(drawn.graph, coming);
  return {fading.graph, std::move(fading.opacity)};
}

void FrameSynthesis::each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context) {
  const sketch::FrameRenderer painter(look_);
  const auto room = static_cast<std::size_t>(batch());
  std::vector<sketch::FrameContent> parts(room);
  std::vector<cv::Mat> frames(room);
  core::parallel_stream(static_cast<std::size_t>(count), room, context,
                        {[&](std::size_t i) { parts[i % room] = next_parts(); },
                         [&](std::size_t i) { frames[i % room] = painter.draw(parts[i % room]); },
                         [&](std::size_t i) { take(std::move(frames[i % room])); }});
}

std::vector<cv::Mat> FrameSynthesis::next(int count, const core::Context& context) {
  std::vector<cv::Mat> frames;
  each(
      count, [&](cv::Mat frame) { frames.push_back(std::move(frame)); }, context);
  return frames;
}

std::vector<sketch::FrameContent> FrameSynthesis::parts(int count, const core::Context& context) {
  std::vector<sketch::FrameContent> all;
  for (int i = 0; i < count; ++i) {
    context.check();
    all.push_back(next_parts());
  }
  return all;
}

}  // namespace emberfold::pipeline
