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

// The fine texture between strokes that diffusion does not reproduce: grain, ripples, cloth. Described by its
// correlation in space and from frame to frame, and by its strength at each place.
namespace emberfold::pipeline {

/// Holds the texture of a clip's residual.
struct ResidualTexture {
  /// One texture for each principal component of the colours, largest first; a single one if grey. In units
  /// of `strength`.
  std::vector<dytex::GaussianTexture> textures;
  cv::Mat colours;  ///< CV_32F, square, a row a component: blue, green, red; orthonormal
  cv::Mat strength;  ///< CV_32F, ≥ 0, over cells of kBackgroundCell px: joint SD of all channels, grey levels
  double speed = 1;  ///< of playback, −100…100, not 0; below 0 backwards
  [[nodiscard]] bool empty() const { return textures.empty(); }
};

/// Measures the residual of a clip beyond the drawing of its sketch, a graph for each frame.
/// Uses up to twenty pairs of neighbouring frames (fewer of large frames: five million pixels in all), 3 px
/// and more from patches and off static pixels. The mean within some 4 px (Gaussian) is subtracted, since
/// coarser residuals come from missed strokes. Empty where there is no such residual, or one frame alone.
/// Reads the clip once, and keeps the residuals of these pairs meanwhile. Throws core::Cancelled.
ResidualTexture measure_residual(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                                 const sketch::RenderOptions& look, const core::Context& context);

/// Draws an endless number of new frames of the residual, the same at any number of threads.
class ResidualFrames {
 public:
  ResidualFrames(const ResidualTexture& residual, cv::Size frame, std::uint64_t seed, double speed = 1);
  /// Returns the next frame, CV_8S, 1 or 3 channels, to be added to a frame.
  cv::Mat next();

 private:
  std::vector<dytex::GaussianTextureFrames> frames_;
  cv::Mat colours_, strength_;
};

/// Adds the arrays "residual_within", "_ahead", "_colours", "_strength" and, of an edited one, "_speed" to a
/// motion model's archive.
void add_residual(core::ModelArchive& archive, const ResidualTexture& residual);
/// Reads the residual; empty where the archive has none.
/// Throws core::IoError, naming the array, where the arrays do not fit the frame.
ResidualTexture read_residual(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::pipeline
