// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"
#include "sketch/background/background.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

/// Holds the frames of a clip that differ from the ones before them, compressed (io::encode_frame).
struct Footage {
  cv::Size size;     ///< px
  int channels = 1;  ///< 1 or 3
  std::vector<std::vector<std::uint8_t>> frames;
  graph::MotionGraph strokes = {};  ///< seen in the frames; empty if unknown

  [[nodiscard]] bool empty() const { return frames.empty(); }
};

/// Holds a clip's model: strokes, their motion, and everything that its frames are drawn with.
struct ClipModel {
  mcmc::MotionModel motion;
  sketch::Background background;  ///< static pixels between the strokes, and the range of levels
  sketch::Sharpening sharpening;
  std::optional<Footage> footage = {};  ///< for every SynthesisMethod but diffusion
};

/// Packs a model for its folder: model.json and arrays.
core::ModelArchive to_archive(const ClipModel& model);

/// Reads a model from an archive. Arrays and parts of older versions that it does not know are ignored.
/// Throws core::IoError, without a folder's name, for an archive that is no model.
ClipModel clip_model(const core::ModelArchive& archive);

/// Returns why no clip can be drawn from a model (no exemplars, all rates 0); empty if one can.
std::string why_undrawable(const mcmc::MotionModel& model);

/// The way a new clip is made: of the clip's own frames, of strokes, or of a texture.
enum class SynthesisMethod {
  footage,    ///< frames of the clip, played in a new order and composed anew; no stroke is drawn
  edit,       ///< frames of the clip; where their strokes are edited, pixels are transferred
  strokes,    ///< strokes of the clip that live again at other times, on the frame that is played
  diffusion,  ///< strokes of the motion model; levels diffuse from them and the still background
  texture     ///< a linear dynamic texture of the clip's frames; no stroke is drawn
};
std::string_view name(SynthesisMethod method);
/// Returns whether whole frames of the clip are shown: footage, edited or not.
inline bool shows_frames(SynthesisMethod method) {
  return method == SynthesisMethod::footage || method == SynthesisMethod::edit;
}
/// Returns the method of that name; nothing for an unknown name.
std::optional<SynthesisMethod> synthesis_method(std::string_view name);

/// Reads a model from its folder, with only the parts that `method` needs; without a method: its footage, if
/// any. Throws core::IoError, naming the folder, where it is no such model, of a newer version, cannot be
/// drawn from (no exemplars, all rates 0), or lacks that part.
ClipModel read_clip_model(const std::string& folder, std::optional<SynthesisMethod> method);

/// Returns whether the model in a folder holds the strokes of its clip's frames, for SynthesisMethod::edit
/// and strokes.
bool holds_footage_strokes(const std::string& folder);

/// Finds the sharpening at which the mean gradient on the flanks of patches over 60 frames is `wanted`.
/// `wanted`: levels/px, the clip's own. Throws core::Cancelled.
sketch::Sharpening fit_sharpening(const mcmc::MotionModel& model, const sketch::Background& background,
                                  double wanted, std::uint64_t seed, const core::Context& context = {});

}  // namespace emberfold::pipeline
