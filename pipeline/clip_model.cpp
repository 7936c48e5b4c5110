// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_model.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "core/text/size_text.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/compression.hpp"
#include "pipeline/footage/footage_strokes.hpp"
#include "pipeline/frame_synthesis.hpp"

namespace emberfold::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr const char* kTexturePart = "texture";  // the folder next to model.json
constexpr std::array kFills = {ModelFill::footage, ModelFill::carried, ModelFill::diffusion,
                               ModelFill::texture, ModelFill::dytex};

bool never_changes(const mcmc::OperatorRates& rates) {
  const auto zero = [](double rate) { return rate == 0; };
  return std::ranges::all_of(rates.birth.values, zero) && std::ranges::all_of(rates.death_by_size, zero) &&
         rates.split == 0 && rates.merge == 0 && rates.connect == 0 && rates.disconnect == 0;
}

void check_size(const dytex::LinearDynamicTexture& texture, const mcmc::MotionModel& model,
                const std::string& what) {
  const auto& info = texture.info;
  if (info.width != model.width || info.height != model.height)
    throw core::IoError(what + " is of frames of " + core::size_text(info.width, info.height) +
                        ", the model of " + core::size_text(model.width, model.height));
}

dytex::LinearDynamicTexture read_texture(const std::string& folder, const mcmc::MotionModel& model) {
  const auto path = (fs::path(folder) / kTexturePart).string();
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
  check_size(texture, model, path);
  return texture;
}

/// Reads the residual; nothing where the archive holds none.
std::optional<ResidualTexture> residual_of(const core::ModelArchive& archive, const ClipModel& model) {
  auto residual = read_residual(archive, {model.motion.width, model.motion.height});
  if (residual.empty()) return std::nullopt;
  const auto channels = static_cast<std::size_t>(render_options(model.motion, model.background).channels);
  if (residual.textures.size() != channels)
    throw core::IoError("motion model: residual_within.npy is of " +
                        std::to_string(residual.textures.size()) + " channels, its frames have " +
                        std::to_string(channels));
  return residual;
}

/// Reads the footage; nothing where the archive holds none.
std::optional<Footage> footage_of(const core::ModelArchive& archive, const ClipModel& model,
                                  bool with_strokes) {
  auto footage = read_footage(archive, {model.motion.width, model.motion.height});
  if (footage.empty()) return std::nullopt;
  if (!with_strokes) return footage;
  footage.strokes = read_footage_strokes(archive, footage.frames.size());
  auto& sketch = footage.strokes.sketch;
  sketch.width = model.motion.width, sketch.height = model.motion.height, sketch.fps = model.motion.fps;
  return footage;
}

/// Reads all but the residual, the footage and the parts.
ClipModel strokes_and_background(const core::ModelArchive& archive) {
  ClipModel model;
  model.motion = mcmc::motion_model(archive);
  model.background = sketch::read_background(archive, {model.motion.width, model.motion.height});
  model.sharpening = sketch::read_sharpening(archive);
  model.correction = read_rate_correction(archive);
  return model;
}

}  // namespace

core::ModelArchive to_archive(const ClipModel& model) {
  auto archive = mcmc::to_archive(model.motion);
  sketch::add_background(archive, model.background);
  if (model.residual) add_residual(archive, *model.residual);
  sketch::add_sharpening(archive, model.sharpening);
  if (model.correction) add_rate_correction(archive, *model.correction);
  if (model.footage) add_footage(archive, *model.footage);
  if (model.texture) archive.parts[kTexturePart] = dytex::to_archive(*model.texture, dytex::Precision::f16);
  return archive;
}

ClipModel clip_model(const core::ModelArchive& archive) {
  ClipModel model = strokes_and_background(archive);
  model.residual = residual_of(archive, model);
  model.footage = footage_of(archive, model, true);
  if (const auto part = archive.parts.find(kTexturePart); part != archive.parts.end()) {
    model.texture = dytex::linear_dynamic_texture(part->second);
    check_size(*model.texture, model.motion, "the texture between the strokes");
  }
  return model;
}

std::string_view name(ModelFill fill) {
  if (fill == ModelFill::footage) return "footage";
  if (fill == ModelFill::carried) return "carried";
  if (fill == ModelFill::diffusion) return "diffusion";
  return fill == ModelFill::texture ? "texture" : "dytex";
}

std::optional<ModelFill> model_fill(std::string_view text) {
  const auto* const found = std::ranges::find(kFills, text, [](ModelFill fill) { return name(fill); });
  return found == kFills.end() ? std::nullopt : std::optional(*found);
}

std::string why_undrawable(const mcmc::MotionModel& model) {
  if (model.exemplars.empty()) return "the model has no exemplars: no stroke can be born of it";
  if (never_changes(model.rates))
    return "all rates of the model are 0: no stroke would be born, die or change";
  return {};
}

ClipModel read_clip_model(const std::string& folder, std::optional<ModelFill> fill) {
  io::ModelLimits limits;
  limits.parts = false;
  const auto archive = io::read_model(folder, io::kMotionFormat, limits);
  ClipModel model;
  try {
    model = strokes_and_background(archive);
    if (fill == ModelFill::texture) {
      model.residual = residual_of(archive, model);
      if (!model.residual)
        throw core::IoError(
            "holds no residual of its clip to draw a texture from; 'emberfold analyze' measures it");
    }
    if (!fill || fill == ModelFill::footage || fill == ModelFill::carried) {
      model.footage = footage_of(archive, model, fill == ModelFill::carried);
      if (fill && !model.footage)
        throw core::IoError("holds no frames of its clip; 'emberfold analyze' keeps them");
      if (fill == ModelFill::carried && model.footage->strokes.sketch.frames.empty())
        throw core::IoError("holds no strokes of its clip's frames; 'emberfold analyze' keeps them");
    }
    if (const auto why = why_undrawable(model.motion); !model.footage && !why.empty())
      throw core::IoError(why);
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
  if (fill == ModelFill::dytex) model.texture = read_texture(folder, model.motion);
  return model;
}

bool holds_footage_strokes(const std::string& folder) {
  std::error_code ignored;
  return fs::exists(fs::path(folder) / "footage_counts.npy", ignored);
}

sketch::Sharpening fit_sharpening(const mcmc::MotionModel& model, const sketch::Background& background,
                                  double wanted, std::uint64_t seed, const core::Context& context) {
  constexpr std::size_t frames = 60, least = 3, most = 10;  // of which some are examined
  constexpr double pixels = 2.5e6;                          // of the examined frames together
  const sketch::RenderOptions look = render_options(model, background);
  auto all = FrameSynthesis(mcmc::Synthesis(model, seed), look).parts(frames, context);
  const auto every = frames / std::clamp(static_cast<std::size_t>(pixels / look.size.area()), least, most);
  std::vector<sketch::FrameContent> some;
  for (std::size_t t = every - 1; t < frames; t += every) some.push_back(std::move(all[t]));
  return fit_sharpening(some, look, wanted, context);
}

}  // namespace emberfold::pipeline
