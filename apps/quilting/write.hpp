// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "apps/cli/command.hpp"
#include "apps/quilting/inputs.hpp"
#include "dytex/quilting/render.hpp"

namespace emberfold::apps {

/// Draws output frames `first` … `first` + `count` − 1 and calls take() in order, while later ones are drawn.
/// Uses loaded clips, otherwise reads them frame by frame. With `to_end` a clip that is shorter than its
/// header says ends the output. Throws core::Cancelled.
void render_frames(const dytex::QuiltMap& map, const QuiltClips& clips, const dytex::TimeControl& control,
                   std::int64_t first, std::int64_t count, bool to_end,
                   const std::function<void(const cv::Mat&)>& take, Session& session);

/// Returns whether a map can be rendered frame by frame within `memory` bytes, without loading the clips.
bool is_streamable(const dytex::TimeControl& control, std::int64_t frames, const core::ClipInfo& info,
                   std::size_t memory);

/// Writes a PNG with 8 or 16 bits. Throws core::IoError naming `shown`.
void write_png(const std::filesystem::path& path, const std::filesystem::path& shown, const cv::Mat& picture);

}  // namespace emberfold::apps
