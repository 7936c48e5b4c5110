// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "mcmc/sampler/evidence.hpp"
#include "sketch/refinement/coding_length.hpp"

namespace emberfold::pipeline {

/// What the frames of a clip say about patches: sketch's gain in coding length, as mcmc asks for it. Keeps
/// the luma of all frames, 4 bytes a pixel.
class ImageEvidence final : public mcmc::Evidence {
 public:
  /// Reads the clip from its first frame, several frames at once. Throws core::Cancelled.
  ImageEvidence(core::FrameSource& source, const core::Context& context);

  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }
  /// core::InputError for a frame that the clip has not.
  [[nodiscard]] double gain(int frame, const graph::Patch& patch) const override;

 private:
  std::vector<sketch::CodingContext> frames_;
};

/// What the patches of some frames gain.
struct GainTotals {
  double nats = 0;
  std::size_t patches = 0, positive = 0;

  void add(const GainTotals& other);
};
/// Over all patches of one frame's graph. `levels`: CV_32F, white = 255.
GainTotals total_gain(const cv::Mat& levels, const graph::AttributeGraph& graph);

}  // namespace emberfold::pipeline
