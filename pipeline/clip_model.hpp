// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/residual_texture.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

/// A clip's model: strokes and their motion, and all that their frames are drawn with.
struct ClipModel {
  mcmc::MotionModel motion;
  sketch::Background background;  ///< what keeps still between the strokes, and the range of levels seen
  sketch::Sharpening sharpening;
  std::optional<ResidualTexture> residual = {};             ///< drawn with by ModelFill::texture
  std::optional<dytex::LinearDynamicTexture> texture = {};  ///< drawn with by ModelFill::dytex
};

/// Turns a model into what its folder holds: model.json and arrays, the linear dynamic texture as the part
/// "texture", in half precision.
core::ModelArchive to_archive(const ClipModel& model);

/// Turns an archive back into the model. core::IoError, without a folder's name, where it is none.
ClipModel clip_model(const core::ModelArchive& archive);

/// Says why no clip can be drawn from a motion model (no exemplars, all rates 0); empty where one can.
std::string why_undrawable(const mcmc::MotionModel& model);

/// What lies between the strokes of a new clip.
enum class ModelFill {
  diffusion,  ///< levels that diffuse from the strokes and the still background
  texture,    ///< diffusion and on it a Gaussian texture with the statistics of the clip's residual
  dytex       ///< a linear dynamic texture learned from the pixels between the strokes
};
std::string_view name(ModelFill fill);
/// Returns the fill of that name, nothing where there is none.
std::optional<ModelFill> model_fill(std::string_view name);

/// Reads a model from its folder, with the part that `fill` draws with and without the others. core::IoError,
/// naming the folder, where it is no such model, of a newer version, cannot be drawn from (no exemplars, all
/// rates 0), or lacks that part.
ClipModel read_clip_model(const std::string& folder, ModelFill fill);

/// Finds how patches are to be drawn so that the mean gradient on their flanks over 60 frames is `wanted`.
/// `wanted`: levels/px, the clip's own. Throws core::Cancelled.
sketch::Sharpening fit_sharpening(const mcmc::MotionModel& model, const sketch::Background& background,
                                  double wanted, std::uint64_t seed, const core::Context& context = {});

}  // namespace emberfold::pipeline
