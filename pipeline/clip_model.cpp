// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_model.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/footage/footage.hpp"
#include "pipeline/footage/footage_strokes.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr std::array kMethods = {SynthesisMethod::footage, SynthesisMethod::edit, SynthesisMethod::strokes,
                                 SynthesisMethod::diffusion, SynthesisMethod::texture};

bool never_changes(const mcmc::OperatorRates& rates) {
  const auto zero = [](double rate) { return rate == 0; };
  return std::ranges::all_of(rates.birth.values, zero) && std::ranges::all_of(rates.death_by_size, zero) &&
         rates.split == 0 && rates.merge == 0 && rates.connect == 0 && rates.disconnect == 0;
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

/// Reads all but the footage.
ClipModel strokes_and_background(const core::ModelArchive& archive) {
  ClipModel model;
  model.motion = mcmc::motion_model(archive);
  model.background = sketch::read_background(archive, {model.motion.width, model.motion.height});
  model.sharpening = sketch::read_sharpening(archive);
  return model;
}

}  // namespace

core::ModelArchive to_archive(const ClipModel& model) {
  auto archive = mcmc::to_archive(model.motion);
  sketch::add_background(archive, model.background);
  sketch::add_sharpening(archive, model.sharpening);
  if (model.footage) add_footage(archive, *model.footage);
  return archive;
}

ClipModel clip_model(const core::ModelArchive& archive) {
  ClipModel model = strokes_and_background(archive);
  model.footage = footage_of(archive, model, true);
  return model;
}

std::string_view name(SynthesisMethod method) {
  if (method == SynthesisMethod::footage) return "footage";
  if (method == SynthesisMethod::edit) return "edit";
  if (method == SynthesisMethod::strokes) return "strokes";
  return method == SynthesisMethod::diffusion ? "diffusion" : "texture";
}

std::optional<SynthesisMethod> synthesis_method(std::string_view text) {
  const auto* const found = std::ranges::find(kMethods, text, [](SynthesisMethod one) { return name(one); });
  return found == kMethods.end() ? std::nullopt : std::optional(*found);
}

std::string why_undrawable(const mcmc::MotionModel& model) {
  if (model.exemplars.empty()) return "the model has no exemplars: no stroke can be born of it";
  if (never_changes(model.rates))
    return "all rates of the model are 0: no stroke would be born, die or change";
  return {};
}

ClipModel read_clip_model(const std::string& folder, std::optional<SynthesisMethod> method) {
  const auto archive = io::read_model(folder, io::kMotionFormat);
  ClipModel model;
  try {
    model = strokes_and_background(archive);
    if (method != SynthesisMethod::diffusion) {
      const bool with_strokes = method == SynthesisMethod::edit || method == SynthesisMethod::strokes;
      model.footage = footage_of(archive, model, with_strokes);
      if (method && !model.footage)
        throw core::IoError("holds no frames of its clip; 'emberfold analyze' keeps them");
      if (with_strokes && model.footage->strokes.sketch.frames.empty())
        throw core::IoError("holds no strokes of its clip's frames; 'emberfold analyze' keeps them");
    }
    if (const auto why = why_undrawable(model.motion); !model.footage && !why.empty())
      throw core::IoError(why);
  } catch (const core::IoError& error) {
    throw core::IoError(folder + ": " + error.what());
  }
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
