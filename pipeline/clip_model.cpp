// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_model.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/compression.hpp"

namespace emberfold::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr const char* texture_folder = "texture";
constexpr std::array kFills = {ModelFill::diffusion, ModelFill::texture, ModelFill::dytex};

bool never_changes(const mcmc::OperatorRates& rates) {
  const auto zero = [](double rate) { return rate == 0; };
  return std::ranges::all_of(rates.birth.values, zero) && std::ranges::all_of(rates.death_by_size, zero) &&
         rates.split == 0 && rates.merge == 0 && rates.connect == 0 && rates.disconnect == 0;
}

void check_drawable(const mcmc::MotionModel& model) {
  if (model.exemplars.empty()) throw core::IoError("the model has no exemplars: no stroke can be born of it");
  if (never_changes(model.rates))
    throw core::IoError("all rates of the model are 0: no stroke would be born, die or change");
}

std::shared_ptr<const dytex::LinearDynamicTexture> open_texture(const std::string& folder,
                                                                const mcmc::MotionModel& model) {
  const auto path = (fs::path(folder) / texture_folder).string();
  std::error_code ignored;
  if (!fs::exists(path, ignored))
    throw core::IoError(
        folder +
        " holds no texture of what lies between the strokes; 'emberfold analyze --texture 30' "
        "learns one");
  const auto archive = io::read_model(path, io::kTextureFormat);
  dytex::LinearDynamicTexture texture;
  try {
    texture = dytex::linear_dynamic_texture(archive);
  } catch (const core::IoError& error) {
    throw core::IoError(path + ": " + error.what());
  }
  const auto& info = texture.info;
  if (info.width != model.width || info.height != model.height)
    throw core::IoError(path + " is of frames of " + std::to_string(info.width) + "x" +
                        std::to_string(info.height) + ", the model of " + std::to_string(model.width) + "x" +
                        std::to_string(model.height));
  return std::make_shared<dytex::LinearDynamicTexture>(std::move(texture));
}

ResidualTexture open_residual(const core::ModelArchive& archive, const mcmc::MotionModel& model,
                              const sketch::Background& ground) {
  auto residual = read_residual(archive, {model.width, model.height});
  if (residual.empty())
    throw core::IoError(
        "holds no residual of its clip to draw a texture from; 'emberfold analyze' measures it");
  const auto channels = static_cast<std::size_t>(render_options(model, ground, {}).channels);
  if (residual.textures.size() != channels)
    throw core::IoError("motion model: residual_within.npy is of " +
                        std::to_string(residual.textures.size()) + " channels, its frames have " +
                        std::to_string(channels));
  return residual;
}

}  // namespace

std::string_view name(ModelFill fill) {
  if (fill == ModelFill::diffusion) return "diffusion";
  return fill == ModelFill::texture ? "texture" : "dytex";
}

std::optional<ModelFill> model_fill(std::string_view text) {
  const auto* const found = std::ranges::find(kFills, text, [](ModelFill fill) { return name(fill); });
  return found == kFills.end() ? std::nullopt : std::optional(*found);
}

ClipModel read_clip_model(const std::string& folder, ModelFill fill) {
  const auto archive = io::read_model(folder, io::kMotionFormat);
  ClipModel opened;
  try {
    opened.motion = mcmc::motion_model(archive);
    opened.ground = sketch::read_background(archive, {opened.motion.width, opened.motion.height});
    opened.sharpening = sketch::read_sharpening(archive);
    if (fill == ModelFill::texture) opened.residual = open_residual(archive, opened.motion, opened.ground);
    check_drawable(opened.motion);
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
  if (fill == ModelFill::dytex) opened.texture = open_texture(folder, opened.motion);
  return opened;
}

ClipSynthesis clip_synthesis(const ClipModel& model, const sketch::FillOptions& fill, std::uint64_t seed,
                             mcmc::Start start) {
  sketch::RenderOptions look =
      sketch::apply_sharpening(render_options(model.motion, model.ground, fill), model.sharpening);
  if (model.texture) return hybrid_frames(model.motion, model.texture, std::move(look), seed, start);
  if (!model.residual.empty())
    return residual_frames(model.motion, model.residual, std::move(look), seed, start);
  return {mcmc::Synthesis(model.motion, seed, start), std::move(look)};
}

sketch::Sharpening fit_sharpening(const mcmc::MotionModel& model, const sketch::Background& ground,
                                  double wanted, std::uint64_t seed, const core::Context& context) {
  constexpr std::size_t frames = 60, every = 6;
  const sketch::RenderOptions look = render_options(model, ground, {});
  auto all = ClipSynthesis(mcmc::Synthesis(model, seed), look).parts(frames, context);
  std::vector<sketch::FrameContent> some;
  for (std::size_t t = every - 1; t < frames; t += every) some.push_back(std::move(all[t]));
  return fit_sharpening(some, look, wanted, context);
}

void write_background_texture(io::OutputFolder& output, const std::string& model_name,
                              const BackgroundTexture& texture) {
  io::write_model(output, model_name + "/" + texture_folder,
                  dytex::to_archive(texture.texture, dytex::Precision::f16));
}

}  // namespace emberfold::pipeline
