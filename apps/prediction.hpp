// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "apps/command.hpp"
#include "apps/ground.hpp"
#include "core/clip.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/fill.hpp"

namespace emberfold::apps {

/// What foretells the held-out frames of a clip, learned from those before `first`.
struct Predictors {
  int first = 0, frames = 0;  ///< held out are the frames first … frames − 1
  const dytex::LinearDynamicTexture* texture = nullptr;
  const std::vector<graph::AttributeGraph>* graphs = nullptr;    ///< of every frame, foretold; null: none
  const std::vector<graph::AttributeGraph>* sketches = nullptr;  ///< of every frame, as it is
  sketch::FillOptions fill;
  Ground ground;  ///< of the frames before `first`
};

/// How near every held-out frame comes to what was foretold of it from the frames before it: for each way
/// {"psnr"}: dB of the mean square error of all frames, pixels and channels. The ways are the frame before,
/// the mean image of the first part, the linear dynamic texture, the motion model's graph, and, as the bound
/// of what a drawn graph can reach, the frame's own sketch. {"first_frame", "frames", "methods",
/// "per_frame"}. Holds a batch of frames. Throws Interrupted.
nlohmann::ordered_json measure_prediction(core::FrameSource& source, const Predictors& predictors,
                                          const Session& session);

}  // namespace emberfold::apps
