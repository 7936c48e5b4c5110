// SPDX-License-Identifier: Apache-2.0
#include "pipeline/image_evidence.hpp"

#include <string>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"

namespace emberfold::pipeline {

ImageEvidence::ImageEvidence(core::FrameSource& source, const core::Context& context) {
  const auto& info = source.info();
  core::stream_frames(
      source, "evidence", info.frames, context,
      [&](int, const cv::Mat& frame) { return sketch::prepare_coding(core::to_levels(frame, info)); },
      [&](int, sketch::CodingContext frame) { frames_.push_back(std::move(frame)); });
}

double ImageEvidence::gain(int frame, const graph::Patch& patch) const {
  if (frame < 0 || frame >= frames())
    throw core::InputError("evidence of frame " + std::to_string(frame) + "; the clip has frames 0…" +
                           std::to_string(frames() - 1));
  return sketch::coding_gain(frames_[static_cast<std::size_t>(frame)], patch);
}

void GainTotals::add(const GainTotals& other) {
  nats += other.nats;
  patches += other.patches;
  positive += other.positive;
}

GainTotals total_gain(const cv::Mat& levels, const graph::AttributeGraph& graph) {
  GainTotals totals;
  if (graph.empty()) return totals;
  const auto frame = sketch::prepare_coding(levels);
  for (const auto& vertex : graph.vertices()) {
    const double gain = sketch::coding_gain(frame, vertex.patch);
    totals.nats += gain;
    totals.positive += gain > 0 ? 1 : 0;
    ++totals.patches;
  }
  return totals;
}

}  // namespace emberfold::pipeline
