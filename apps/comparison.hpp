// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/command.hpp"
#include "apps/output_folder.hpp"
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
};

/// What the caller has already made of the whole clip; what is null is made here.
struct KnownModels {
  const SketchedClip* sketched = nullptr;  ///< as extracted: match() steadies a sketch with frames to come
  const graph::MotionGraph* motion = nullptr;
  const mcmc::MotionModel* motion_model = nullptr;
  const dytex::LinearDynamicTexture* texture = nullptr;
};

struct Comparison {
  nlohmann::ordered_json measures;  ///< the content of measures.json
  std::vector<std::string> files;   ///< what was written into the output, by name
};

/// The fewest frames that a comparison takes.
constexpr int kFewestFrames = 8;

/// Holds a clip against a motion model and a linear dynamic texture of it. Each, learned from the first half,
/// foretells every frame of the second from those before; each, learned from all of it, draws a clip of the
/// same length, whose spectra in time and space are held against the clip's own, beside the noise floor: how
/// far the clip's own halves lie apart. Writes synthesized_motion.avi, synthesized_dytex.avi,
/// side_by_side.mp4 and measures.json ("emberfold.measures", version 1). Reads the clip some six times and
/// keeps of it a batch of frames. A model that cannot be learned from this clip is left out, with a warning.
/// `clip`: its name. core::IoError for fewer than kFewestFrames frames. Throws Interrupted.
Comparison compare_clip(core::FrameSource& source, const std::string& clip, const CompareOptions& options,
                        const KnownModels& known, OutputFolder& output, Session& session);

/// Holds two clips against each other: the distances of their spectra beside those of a's own halves, and the
/// PSNR where sizes, channels and lengths agree. Writes side_by_side.mp4, as long as the shorter one, and
/// measures.json. The rest as above.
Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, OutputFolder& output, Session& session);

/// The measures as a table to read.
std::string comparison_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
