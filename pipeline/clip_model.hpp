// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/footage/footage.hpp"
#include "pipeline/rate_correction.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::pipeline {

/// Holds a clip's model: strokes, their motion, and everything that its frames are drawn with.
struct ClipModel {
  mcmc::MotionModel motion;
  sketch::Background background;  ///< static pixels between the strokes, and the range of levels
  sketch::Sharpening sharpening;
  std::optional<Footage> footage = {};            ///< for ModelFill::footage, carried and strokes
  std::optional<RateCorrection> correction = {};  ///< applied when strokes are first drawn
};

/// Packs a model for its folder: model.json and arrays.
core::ModelArchive to_archive(const ClipModel& model);

/// Reads a model from an archive. Arrays and parts of older versions that it does not know are ignored.
/// Throws core::IoError, without a folder's name, for an archive that is no model.
ClipModel clip_model(const core::ModelArchive& archive);

/// Returns why no clip can be drawn from a model (no exemplars, all rates 0); empty if one can.
std::string why_undrawable(const mcmc::MotionModel& model);

/// Source of a new clip: the clip's own frames, or strokes and a fill between them.
enum class ModelFill {
  footage,   ///< frames of the clip, played in a new order and composed anew; no stroke is drawn
  carried,   ///< frames of the clip; where their strokes are edited, pixels are transferred
  strokes,   ///< strokes of the clip that live again at other times, what lies between them by a linear
             ///< texture
  diffusion  ///< levels diffused from the strokes and the still background
};
std::string_view name(ModelFill fill);
/// Returns whether whole frames of the clip are shown: footage, edited or not.
inline bool shows_frames(ModelFill fill) {
  return fill == ModelFill::footage || fill == ModelFill::carried;
}
/// Returns the fill of that name; nothing for an unknown name.
std::optional<ModelFill> model_fill(std::string_view name);

/// Reads a model from its folder, with only the parts that `fill` needs; without a fill: its footage, if any.
/// Throws core::IoError, naming the folder, where it is no such model, of a newer version, cannot be drawn
/// from (no exemplars, all rates 0), or lacks that part.
ClipModel read_clip_model(const std::string& folder, std::optional<ModelFill> fill);

/// Returns whether the model in a folder holds the strokes of its clip's frames, for ModelFill::carried and
/// strokes.
bool holds_footage_strokes(const std::string& folder);

/// Finds the sharpening at which the mean gradient on the flanks of patches over 60 frames is `wanted`.
/// `wanted`: levels/px, the clip's own. Throws core::Cancelled.
sketch::Sharpening fit_sharpening(const mcmc::MotionModel& model, const sketch::Background& background,
                                  double wanted, std::uint64_t seed, const core::Context& context = {});

}  // namespace emberfold::pipeline
