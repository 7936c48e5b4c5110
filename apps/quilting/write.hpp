// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "apps/cli/command.hpp"
#include "apps/quilting/inputs.hpp"
#include "dytex/quilting/render.hpp"

namespace emberfold::apps {

/// Draws output frames `first` … `first` + `count` − 1 and hands them on in order, while the next ones are
/// drawn: from what is held, else frame by frame from the clips. With `to_end` a clip that turns out to be
/// shorter than told ends the output too. Throws core::Cancelled.
void render_frames(const dytex::QuiltMap& map, const QuiltClips& clips, const dytex::TimeControl& control,
                   std::int64_t first, std::int64_t count, bool to_end,
                   const std::function<void(const cv::Mat&)>& take, Session& session);

/// Whether a map can be rendered frame by frame, without reading the clips whole: few frames at once.
bool is_streamable(const dytex::TimeControl& control, std::int64_t frames, const core::ClipInfo& info,
                   std::size_t memory);

/// One image as PNG, 8 or 16 bits; core::IoError naming `shown`.
void write_png(const std::filesystem::path& path, const std::filesystem::path& shown, const cv::Mat& picture);

}  // namespace emberfold::apps
