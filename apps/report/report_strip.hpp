// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "apps/cli/command.hpp"
#include "apps/report/report_model.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"

namespace emberfold::apps {

struct NamedSource {
  std::string name;
  core::FrameSource* source = nullptr;
};

/// Puts clips side by side into one video of at most kClipBytes, as many frames as the shortest has (at most
/// 250), each at the size of the first and no larger than 400 px: first smaller, then shorter until it fits.
/// The video passes through `output`'s stage and does not stay there. At least one clip of at least one
/// frame; throws core::Cancelled.
ReportClips make_strip(std::span<const NamedSource> clips, const io::OutputFolder& output,
                       const Session& session);

}  // namespace emberfold::apps
