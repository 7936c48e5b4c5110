// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/cli/command.hpp"
#include "apps/comparison/comparison_films.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "pipeline/compare.hpp"

namespace emberfold::apps {

/// Holds a comparison as written by the command.
struct Comparison {
  nlohmann::ordered_json measures;  ///< the content of measures.json
  std::vector<std::string> files;   ///< names of the files written into the output
  std::vector<ComparedFrame> pictures = {};
  cv::Mat sheet = {};  ///< contact_sheet.png, CV_8UC3
};

/// Compares a clip with models of it (pipeline::compare_models). Writes a clip drawn from each model,
/// side_by_side.mp4 and measures.json. `clip`: its name. Throws core::IoError for a clip that is too short,
/// core::Cancelled.
Comparison compare_clip(core::FrameSource& source, const std::string& clip,
                        const pipeline::CompareOptions& options, const pipeline::KnownModels& known,
                        io::OutputFolder& output, Session& session);

/// Compares two clips (pipeline::compare). Writes side_by_side.mp4, as long as the shorter one, and
/// measures.json. Throws like compare_clip().
Comparison compare_clips(core::FrameSource& a, const std::string& name_a, core::FrameSource& b,
                         const std::string& name_b, const pipeline::CompareOptions& options,
                         io::OutputFolder& output, Session& session);

}  // namespace emberfold::apps
