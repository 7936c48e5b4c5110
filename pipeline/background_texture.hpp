// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "graph/attribute_graph.hpp"

// What lies between the strokes and moves without a shape: learned as a linear dynamic texture of a clip
// whose sketchable part is hidden, frame by frame, so that strokes have no part in it.
namespace emberfold::pipeline {

struct BackgroundTextureOptions {
  int components =
      30;          ///< 1…500; at most a third of the frames are used: more would fit a short clip's chance
  int rounds = 2;  ///< 0…100: how often the texture is learned again from what it says of the hidden pixels
  void validate() const;
};

struct BackgroundTexture {
  dytex::LinearDynamicTexture texture;
  double hidden = 0;               ///< share of the clip's pixels that patches cover, 0…1
  std::vector<std::string> notes;  ///< a line for everything that was not taken as asked or measured
};

/// Learns from a clip and its sketch, a graph for each frame, in order: what draw_fitted shows of a graph is
/// hidden. At first hidden pixels have what diffuses into them from their surroundings; learned in closed
/// form from that, the texture says what they may have been, and is learned from that again. (Maximum
/// likelihood on the seen pixels alone, dytex::learn_missing, is what many rounds come to. Pixels that are
/// seldom seen take any value in it, and drawn clips show them as specks; a few rounds leave them near the
/// diffusion.) A clip of more than 5000 frames is learned from its first 5000. InputError where there are
/// fewer than 6 frames, or graphs and frames differ in number; throws core::Cancelled. Costs dytex::learn 1 +
/// rounds times, and a fill for each frame.
BackgroundTexture learn_background_texture(core::FrameSource& source,
                                           std::span<const graph::AttributeGraph> graphs,
                                           const BackgroundTextureOptions& options = {},
                                           const core::Context& context = {});

}  // namespace emberfold::pipeline
