// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/io/staged_output.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/background_texture.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/residual_texture.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/sharpening.hpp"

// A model's folder, and the clips that are drawn from it.
namespace emberfold::pipeline {

/// What lies between the strokes of a new clip.
enum class ModelFill {
  diffusion,  ///< what diffuses from the strokes and the still ground
  texture,    ///< and on it a Gaussian texture as the clip's residual
  dytex       ///< a linear dynamic texture of what is no stroke
};
std::string_view name(ModelFill fill);
/// Returns the fill of that name, nothing where there is none.
std::optional<ModelFill> model_fill(std::string_view name);

/// A motion model and what its frames are drawn with.
struct ClipModel {
  mcmc::MotionModel motion;
  sketch::Background ground;
  sketch::Sharpening sharpening;
  ResidualTexture residual;                                    ///< with ModelFill::texture
  std::shared_ptr<const dytex::LinearDynamicTexture> texture;  ///< with ModelFill::dytex
};

/// Reads a motion model from its folder, and the texture in it where that is what it is drawn with.
/// core::IoError, naming the folder: it is no such model, of a newer version, has no exemplars, no rate above
/// zero, no texture, or one of another size.
ClipModel read_clip_model(const std::string& folder, ModelFill fill);

ClipSynthesis clip_synthesis(const ClipModel& model, const sketch::FillOptions& fill, std::uint64_t seed,
                             mcmc::Start start = mcmc::Start::data);

/// How a new model's patches are to be drawn so that the gradient on their flanks, in the mean of 60 frames,
/// is `wanted`, the clip's. Throws core::Cancelled.
sketch::Sharpening fit_sharpening(const mcmc::MotionModel& model, const sketch::Background& ground,
                                  double wanted, std::uint64_t seed, const core::Context& context = {});

/// The folder "texture" beside a motion model's files: an emberfold.linear_dynamic_texture in half precision.
void write_background_texture(io::OutputFolder& output, const std::string& model_name,
                              const BackgroundTexture& texture);

}  // namespace emberfold::pipeline
