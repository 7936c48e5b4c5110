// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/error.hpp"
#include "core/option_field.hpp"
#include "dytex/learn.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/comparison/comparison_results.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

/// Minimum number of frames of a clip that is compared.
constexpr int kFewestFrames = 8;
/// Maximum number of frames of a synthesized clip.
constexpr int kMostSynthesized = 1'000'000;

/// Holds the settings of compare() and compare_models().
struct CompareOptions {
  sketch::ExtractOptions sketch = kFollowedSketch;
  graph::MatchOptions match;
  dytex::LearnOptions
      learn;  ///< at most a third of the frames as components: more would overfit a short clip
  double learn_share = 0.5;
  int steps = 8;
  int frames = 0;
  /// The STAR model too, and strokes of the drawn clips, which takes twice as long.
  bool in_full = true;

  /// Returns the fields' descriptions for checks, help and docstrings.
  static auto fields() {
    using core::above, core::between;
    return std::to_array<core::OptionField<CompareOptions>>({
        {"learn_share", &CompareOptions::learn_share, "SHARE", above(0, 1),
         "Learn from this first part of the clip; predict the rest"},
        {"steps", &CompareOptions::steps, "N", between(1, 64), "Predict up to this many frames ahead"},
        {"frames", &CompareOptions::frames, "N",
         between(kFewestFrames, kMostSynthesized, "the number that the source has"),
         "Draw this many frames from each model"},
    });
  }
  /// Throws InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// Holds results for the whole clip that the caller already has; the comparison computes null ones.
struct KnownModels {
  const SketchedClip* sketched = nullptr;  ///< as extracted, since match() removes flicker with later frames
  /// Models of the whole clip. Clips are drawn from them instead of from those of the clip's first part.
  const mcmc::MotionModel* motion_model = nullptr;
  const sketch::Sharpening* sharpening = nullptr;  ///< of motion_model; null: none
  const dytex::LinearDynamicTexture* texture = nullptr;
};

/// Reports a clip with fewer than kFewestFrames frames.
class ShortClipError : public core::InputError {
 public:
  ShortClipError(int clip, int frames);

  int clip;    ///< index among the arguments, from 0
  int frames;  ///< number of its frames
};
/// Returns "<name> holds 7 frames; a comparison needs at least 8".
std::string short_clip_text(const std::string& name, int frames);

/// Names a clip of a comparison to its observer.
struct ObservedClip {
  std::string key;    ///< "a" and "b", or "source" and the key of each model
  std::string label;  ///< for display
  core::ClipInfo info;
  int frames = 0;
};

/// Receives the frames of all clips while they are compared, to write or display them.
/// Either function may be empty. Both are called on the thread of the caller; an exception from them ends the
/// comparison.
struct CompareObserver {
  /// Called once, before the first frame.
  std::function<void(std::span<const ObservedClip> clips)> begin;
  /// Called with the next frames (CV_8U) of each clip, from frame `first` on; fewer or none where it has
  /// ended.
  std::function<void(int first, std::span<const std::vector<cv::Mat>> clips)> take;
};

/// Holds the comparison of two clips.
struct ClipComparison {
  MeasureScale scale;
  int frames_a = 0, frames_b = 0;
  ClipProfile a, b;
  ClipDistances distances;           ///< of b from a
  ClipDistances noise_floor;         ///< of a's first half from its second
  std::optional<double> psnr, ssim;  ///< of all frames: dB, at most 100; −1…1, of luma
  std::string no_psnr_reason;        ///< why psnr and ssim are missing
};

/// Measures the distances of clip `b` from clip `a`, of pixels and strokes.
/// Pixels are compared by spectra, flow, patterns and sharpness. Distances should be compared with the noise
/// floor, the distance between a's own halves. PSNR and SSIM are measured where sizes, channels and lengths
/// agree. Reads both clips twice and keeps a batch of frames. The result is the same at any number of
/// threads. Throws ShortClipError, InputError for options out of range, core::Cancelled. Example:
///     const auto found = pipeline::compare(*clip, *other);
///     std::cout << found.distances.pixels.temporal_db << " dB, floor " <<
///     found.noise_floor.pixels.temporal_db;
ClipComparison compare(core::FrameSource& a, core::FrameSource& b, const CompareOptions& options = {},
                       const core::Context& context = {}, const CompareObserver& observer = {});

/// Holds a model of a comparison and the clip that was drawn from it.
struct ModelResult {
  std::string key, label;  ///< key: "motion_model", "footage", "linear_dynamic_texture" or "star"
  double parameters = 0;   ///< numbers needed to draw from the model
  ClipProfile drawn;
  ClipDistances distances;  ///< of the drawn clip from the source
};

/// Holds the comparison of a clip with its models.
struct ModelComparison {
  MeasureScale scale;
  int frames = 0, learned_frames = 0;  ///< of the clip; of its first part, which the models are learned from
  int drawn_frames = 0;                ///< of each model's clip
  ClipProfile source;
  ClipDistances noise_floor;                     ///< of the source's first half from its second
  std::vector<ModelResult> models;               ///< those that could be learned
  std::optional<PredictionMeasures> prediction;  ///< none where no frames remain to be predicted
};

/// Learns models of a clip from its first part and compares them with the clip.
/// It measures the predictions of the rest, the reconstruction of given frames, and the distances of a new
/// clip drawn from each model. A model that cannot be learned from this clip is left out, with a warning.
/// Keeps a batch of frames and all graphs. The result is the same at any number of threads. Throws
/// ShortClipError, InputError for options out of range, core::IoError where the clip changes while it is
/// read, core::Cancelled.
ModelComparison compare_models(core::FrameSource& source, const CompareOptions& options = {},
                               const KnownModels& known = {}, std::uint64_t seed = 1,
                               const core::Context& context = {}, const CompareObserver& observer = {});

}  // namespace emberfold::pipeline
