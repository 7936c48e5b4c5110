// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/attribute_graph.hpp"
#include "mcmc/sampler/evidence.hpp"
#include "sketch/refinement/coding_length.hpp"

namespace emberfold::pipeline {

/// Computes the evidence of patches from a clip's frames: the gain in coding length that the library sketch
/// computes.
/// Keeps the luma of all frames, 4 bytes a pixel.
class ImageEvidence final : public mcmc::Evidence {
 public:
  /// Reads the clip from its first frame, several frames at once. Throws core::Cancelled.
  ImageEvidence(core::FrameSource& source, const core::Context& context);

  [[nodiscard]] int frames() const { return static_cast<int>(frames_.size()); }
  /// Returns the gain, nats. Throws core::InputError for a frame outside the clip.
  [[nodiscard]] double gain(int frame, const graph::Patch& patch) const override;

 private:
  std::vector<sketch::CodingContext> frames_;
};

/// Holds the summed gain of the patches of some frames.
struct GainTotals {
  double nats = 0;
  std::size_t patches = 0, positive = 0;

  void add(const GainTotals& other);
};
/// Sums the gain of all patches of one frame's graph. `levels`: CV_32F, white = 255.
GainTotals total_gain(const cv::Mat& levels, const graph::AttributeGraph& graph);

}  // namespace emberfold::pipeline
