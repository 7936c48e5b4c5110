// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "apps/cli/command.hpp"
#include "apps/report/report_model.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"

namespace emberfold::apps {

/// A clip and the label below it.
struct NamedSource {
  std::string name;
  core::FrameSource* source = nullptr;
};

/// Joins clips side by side into one video of at most kClipBytes.
/// Its length is that of the shortest clip, at most 250 frames; each clip has the size of the first, at most
/// 400 px. Reduces the size, then the length, until it fits. The video is written to `output`'s staging
/// folder and removed from it. Takes at least one clip of at least one frame. Throws core::Cancelled.
ReportClips make_strip(std::span<const NamedSource> clips, const io::OutputFolder& output,
                       const Session& session);

}  // namespace emberfold::apps
