// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "apps/comparison.hpp"

namespace emberfold::apps {

/// What a comparison needs of a clip's models.
struct ComparedModels {
  int frames = 0, half = 0;                            ///< of the clip; learned from for the prediction
  std::optional<mcmc::MotionModel> motion;             ///< of the whole clip
  std::optional<dytex::LinearDynamicTexture> texture;  ///< of the whole clip
  std::optional<dytex::LinearDynamicTexture> half_texture;
  Ground ground, half_ground;                    ///< of the whole clip, of its first half
  std::vector<graph::AttributeGraph> sketches;   ///< of every frame
  std::vector<graph::AttributeGraph> predicted;  ///< of every frame by the first half's motion model; or none
};

/// Learns what is not known. Throws Interrupted.
ComparedModels learn_models(core::FrameSource& source, const std::string& clip, const CompareOptions& options,
                            const KnownModels& known, Session& session);

/// core::IoError for a clip with too few frames to compare.
void need_frames(const std::string& clip, std::int64_t frames);

}  // namespace emberfold::apps
