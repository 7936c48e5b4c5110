// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Opens a clip: a video, a folder of images, a pattern of images (dir/img_*.png, dir/img_%04d.png; natural
/// order), a TIFF whose pages are the frames (decode_tiff), one image, or "-" and other pipes (PipedClip).
/// Frames are read one by one; only the current one is kept. `info().frames` is the number known without
/// reading: for a video the container's claim, until the end was reached once. Shrinking averages areas,
/// growing is bicubic. Throws core::IoError where the file cannot be read as a clip; core::InputError where
/// the options are wrong or the range begins after the last frame. A range that ends after it is cut, with a
/// warning.
std::unique_ptr<core::FrameSource> open_video(const std::string& name, const ReadOptions& options = {},
                                              const core::Warn& warn = {});

/// Opens a clip in memory with the options of open_video; messages call it `name`.
std::unique_ptr<core::FrameSource> open_clip(core::Clip clip, const std::string& name,
                                             const ReadOptions& options, const core::Warn& warn = {});

}  // namespace emberfold::io
