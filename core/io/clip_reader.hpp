// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::io {

struct ReadOptions {
  std::int64_t first = 0;            ///< first frame, from 0
  std::optional<std::int64_t> last;  ///< one past the last frame, > first; none: to the end
  double scale = 1;                  ///< (0, 16]; sizes are rounded, at least 1 px
  bool grey = false;                 ///< luma (Rec. 601) only
  std::uint64_t seed = 1;            ///< of built-in clips

  /// core::InputError naming field, value and range.
  void validate() const;
};

/// Parses a range of frames: "a:b" (from a up to, not including, b), "a:" or ":b". Throws core::InputError
/// for any other text and for an empty range.
std::pair<std::int64_t, std::optional<std::int64_t>> parse_range(const std::string& text);

/// Opens a clip: a video, a folder of images, a pattern of images (dir/img_*.png, dir/img_%04d.png; natural
/// order), a TIFF whose pages are the frames (decode_tiff), or one image. Frames are read one by one; nothing
/// but the frame at hand is kept. `info().frames` is what is known without reading: for a video the
/// container's claim, until the end was reached once. Shrinking averages areas, growing is bicubic.
/// core::IoError where the file cannot be read as a clip; core::InputError where the options are wrong or the
/// range begins behind the last frame. A range that ends behind it is cut, with a warning.
std::unique_ptr<core::FrameSource> open_video(const std::string& name, const ReadOptions& options = {},
                                              const core::Warn& warn = {});

/// Opens a clip in memory with the options of open_video; messages call it `name`.
std::unique_ptr<core::FrameSource> open_clip(core::Clip clip, const std::string& name,
                                             const ReadOptions& options, const core::Warn& warn = {});

}  // namespace emberfold::io
