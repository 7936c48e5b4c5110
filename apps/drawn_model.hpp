// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "apps/draw_model.hpp"
#include "apps/ground.hpp"
#include "apps/ground_texture.hpp"
#include "apps/output_folder.hpp"
#include "apps/residual_texture.hpp"
#include "apps/sharpening.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "mcmc/motion_model.hpp"

// A model's folder, and the clips that are drawn from it.
namespace emberfold::apps {

/// What lies between the strokes of a new clip.
enum class ModelFill {
  diffusion,  ///< what diffuses from the strokes and the still ground
  texture,    ///< and on it a Gaussian texture as the clip's residual
  dytex       ///< a linear dynamic texture of what is no stroke
};
std::string_view name(ModelFill fill);
/// Misuse where there is none of that name.
ModelFill model_fill(const std::string& name);

/// A motion model and what its frames are drawn with.
struct DrawnModel {
  mcmc::MotionModel motion;
  Ground ground;
  Sharpening sharpening;
  ResidualTexture residual;                                    ///< with ModelFill::texture
  std::shared_ptr<const dytex::LinearDynamicTexture> texture;  ///< with ModelFill::dytex
};

/// Reads a motion model from its folder, and the texture in it where that is what it is drawn with.
/// core::IoError, naming the folder: it is no such model, of a newer version, has no exemplars, no rate above
/// zero, no texture, or one of another size.
DrawnModel open_drawn_model(const std::string& folder, ModelFill fill);

ModelFrames model_frames(const DrawnModel& model, const sketch::FillOptions& fill, std::uint64_t seed,
                         mcmc::Start start = mcmc::Start::data);

/// How a new model's patches are to be drawn so that the gradient on their flanks, in the mean of 60 frames,
/// is `wanted`, the clip's. Throws Interrupted.
Sharpening fit_sharpening(const mcmc::MotionModel& model, const Ground& ground, double wanted,
                          std::uint64_t seed, const core::Context& context = {});

/// The folder "texture" beside a motion model's files: an emberfold.linear_dynamic_texture in half precision.
void write_ground_texture(OutputFolder& output, const std::string& model_name, const GroundTexture& texture);

}  // namespace emberfold::apps
