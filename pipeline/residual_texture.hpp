// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "dytex/baselines/gaussian_texture.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/frame_renderer.hpp"

// The fine texture that a clip shows between its strokes and diffusion does not: grain, ripples, cloth. Told
// by how it goes together in space and from frame to frame, and how strong it is where.
namespace emberfold::pipeline {

struct ResidualTexture {
  /// Of each principal component of its colours, greatest first; one where it is grey. In units of
  /// `strength`.
  std::vector<dytex::GaussianTexture> textures;
  cv::Mat colours;  ///< CV_32F, square, a row a component: blue, green, red; orthonormal
  cv::Mat
      strength;  ///< CV_32F, ≥ 0, over cells of kBackgroundCell px: SD of all channels together, grey levels
  [[nodiscard]] bool empty() const { return textures.empty(); }
};

/// Of a clip and its sketch, a graph for each frame: what some twenty pairs of neighbouring frames show
/// beyond their drawing in this look, 3 px and more from patches and before no backdrop, less its mean within
/// some 4 px (Gaussian): what is coarser tells where strokes were missed. Empty where there is nothing such,
/// or one frame alone. Reads the clip three times; throws core::Cancelled.
ResidualTexture measure_residual(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                                 const sketch::RenderOptions& look, const core::Context& context);

/// New frames of it without an end, the same at any number of threads.
class ResidualFrames {
 public:
  ResidualFrames(const ResidualTexture& residual, cv::Size frame, std::uint64_t seed, double speed = 1);
  /// CV_8S, 1 or 3 channels: to be added to a frame.
  cv::Mat next();

 private:
  std::vector<dytex::GaussianTextureFrames> frames_;
  cv::Mat colours_, strength_;
};

/// The arrays "residual_within", "_ahead", "_colours" and "_strength" beside a motion model's own.
void add_residual(core::ModelArchive& archive, const ResidualTexture& residual);
/// Empty where the archive has none; core::IoError, naming the array, where they do not fit the frame.
ResidualTexture read_residual(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::pipeline
