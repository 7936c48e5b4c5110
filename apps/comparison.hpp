// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "apps/command.hpp"
#include "apps/output_folder.hpp"
#include "apps/sharpening.hpp"
#include "apps/sketch_clip.hpp"
#include "core/clip.hpp"
#include "dytex/learn.hpp"
#include "graph/match.hpp"
#include "mcmc/motion_model.hpp"
#include "sketch/extract.hpp"
#include "sketch/fill.hpp"

namespace emberfold::apps {

struct CompareOptions {
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::FillOptions fill;
  dytex::LearnOptions learn;  ///< at most a third of the frames as components: more fit a short clip's chance
  double learn_share = 0.5;   ///< of the clip, from its beginning, that models learn from; (0, 1]
  int steps = 8;              ///< frames that are foretold at most, 1 … 64
  int frames = 0;             ///< of each synthesized clip; 0: as many as the source has
  bool hybrid = true;         ///< compare the hybrid of motion model and dynamic texture, too
  bool star = true;           ///< and spatio-temporal auto-regression
  bool curve = false;         ///< quality against model size, too
  bool strokes = true;        ///< find strokes in the synthesized clips and measure them

  /// InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// What the caller has already made of the whole clip; what is null is made here.
struct KnownModels {
  const SketchedClip* sketched = nullptr;  ///< as extracted: match() steadies a sketch with frames to come
  /// Models of the whole clip, drawn from instead of those of its first part.
  const mcmc::MotionModel* motion_model = nullptr;
  const Sharpening* sharpening = nullptr;  ///< with motion_model
  const dytex::LinearDynamicTexture* texture = nullptr;
};

/// The same frame of all clips, CV_8UC3.
struct ComparedFrame {
  int frame = 0;
  cv::Mat picture;
};

struct Comparison {
  nlohmann::ordered_json measures;  ///< the content of measures.json
  std::vector<std::string> files;   ///< what was written into the output, by name
  std::vector<ComparedFrame> pictures = {};
};

/// The fewest frames that a comparison takes.
constexpr int kFewestFrames = 8;

/// Holds a clip against models of it (compared_models.hpp), all learned from its first part: how well each
/// foretells the frames of the rest from those before them, 1, 2, 4 … frames ahead; how well it shows a frame
/// that it is given; and how far a new clip drawn from it lies from the source, by every measure of
/// clip_measures.hpp and clip_strokes.hpp, beside the noise floor: how far the clip's own halves lie apart.
/// Writes a clip drawn from each model, side_by_side.mp4 and measures.json ("emberfold.measures", version 2).
/// Keeps of the clip a batch of frames. A model that cannot be learned from this clip is left out, with a
/// warning. `clip`: its name. core::IoError for fewer than kFewestFrames frames. Throws Interrupted.
Comparison compare_clip(core::FrameSource& source, const std::string& clip, const CompareOptions& options,
                        const KnownModels& known, OutputFolder& output, Session& session);

/// Holds two clips against each other by the same measures, beside those of a's own halves, and by PSNR and
/// SSIM where sizes, channels and lengths agree. Writes side_by_side.mp4, as long as the shorter one, and
/// measures.json. The rest as above.
Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, const CompareOptions& options, OutputFolder& output,
                         Session& session);

/// The measures as a table to read.
std::string comparison_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
