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
namespace emberfold::apps {

struct GroundTextureOptions {
  int components =
      30;  ///< 1…500; at most a third of the frames are used: more would fit a short clip's chance
  int iterations = 5;  ///< 0…1000, of expectation and maximisation behind the start
  void validate() const;
};

struct GroundTexture {
  dytex::LinearDynamicTexture texture;
  double hidden = 0;               ///< share of the clip's pixels that patches cover, 0…1
  std::vector<std::string> notes;  ///< a line for everything that was not taken as asked or measured
};

/// Learns from a clip and its sketch, a graph for each frame, in order: what draw_fitted shows of a graph is
/// hidden. The start is the closed form on the clip with what is hidden diffused in from its surroundings
/// (a pixel that is never seen keeps that); then maximum likelihood on what is seen. Reads the clip some
/// 2 + iterations times where it does not fit into a gigabyte, else twice. A clip of more than 5000
/// frames is learned from its first 5000. InputError where there are fewer than 6 frames, or graphs and
/// frames differ in number; throws Interrupted. O(frames · pixels · components), and for hidden pixels
/// O(components²) each, in every iteration.
GroundTexture learn_ground_texture(core::FrameSource& source, std::span<const graph::AttributeGraph> graphs,
                                   const GroundTextureOptions& options = {},
                                   const core::Context& context = {});

}  // namespace emberfold::apps
