// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "graph/attribute_graph.hpp"

// Learns the motion between strokes as a linear dynamic texture of a clip whose sketchable part is hidden,
// frame by frame.
namespace emberfold::pipeline {

/// Holds the settings of learn_background_texture().
struct BackgroundTextureOptions {
  int components =
      30;  ///< 1…500; at most a third of the frames are used, so that a short clip is not overfitted
  int rounds = 2;  ///< 0…100: how often hidden pixels are estimated and the texture is learned again
  void validate() const;
};

/// Holds the learned texture.
struct BackgroundTexture {
  dytex::LinearDynamicTexture texture;
  double hidden = 0;               ///< share of the clip's pixels that patches cover, 0…1
  std::vector<std::string> notes;  ///< one line for each number that was not used as requested or measured
};

/// Learns a texture from a clip with its strokes hidden.
/// `graphs`: the sketch, a graph for each frame in order. Hides the pixels that draw_fitted() draws and first
/// fills them by diffusion. Each round learns the texture in closed form and replaces them by its estimates.
/// Many rounds approach maximum likelihood on the visible pixels (dytex::learn_missing), where rarely visible
/// pixels are undetermined and appear as specks; few rounds keep them near the diffusion. Uses the first 5000
/// frames. Throws InputError for fewer than 6 frames, or where graphs and frames differ in number, and
/// core::Cancelled. Cost: 1 + rounds times dytex::learn(), and a fill for each frame.
BackgroundTexture learn_background_texture(core::FrameSource& source,
                                           std::span<const graph::AttributeGraph> graphs,
                                           const BackgroundTextureOptions& options = {},
                                           const core::Context& context = {});

}  // namespace emberfold::pipeline
