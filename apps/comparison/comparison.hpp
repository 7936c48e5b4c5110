// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "apps/cli/command.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "dytex/learn.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/compare.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/sharpening.hpp"

namespace emberfold::apps {

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

/// Holds a clip against models of it (compared_models.hpp), all learned from its first part: how well each
/// foretells the frames of the rest from those before them, 1, 2, 4 … frames ahead; how well it shows a frame
/// that it is given; and how far a new clip drawn from it lies from the source, by every measure of
/// clip_measures.hpp and clip_strokes.hpp, beside the noise floor: how far the clip's own halves lie apart.
/// Writes a clip drawn from each model, side_by_side.mp4 and measures.json ("emberfold.measures", version 2).
/// Keeps of the clip a batch of frames. A model that cannot be learned from this clip is left out, with a
/// warning. `clip`: its name. core::IoError for fewer than pipeline::kFewestFrames frames. Throws
/// core::Cancelled.
Comparison compare_clip(core::FrameSource& source, const std::string& clip,
                        const pipeline::CompareOptions& options, const pipeline::KnownModels& known,
                        io::OutputFolder& output, Session& session);

/// Holds two clips against each other by the same measures, beside those of a's own halves, and by PSNR and
/// SSIM where sizes, channels and lengths agree. Writes side_by_side.mp4, as long as the shorter one, and
/// measures.json. The rest as above.
Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, const pipeline::CompareOptions& options,
                         io::OutputFolder& output, Session& session);

/// The measures as a table to read.
std::string comparison_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
