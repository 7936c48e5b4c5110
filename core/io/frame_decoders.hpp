// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::io {

/// A clip as it is stored, before range, scale and grey are applied.
class FrameDecoder : public core::FrameSource {
 public:
  /// Passes over one frame, as cheaply as the format allows; false after the last.
  virtual bool skip() = 0;
};

/// A video that FFmpeg decodes: CV_8U, turned as its rotation flag tells; one channel where the stream itself
/// is grey. `info().frames` is what the container claims until the end was reached once, then what was read.
/// core::IoError: no such file, no video, nothing in it that can be decoded, frames that change size.
/// A file that ends before its container claims (by two frames or more) is used as far as it goes, with a
/// warning.
std::unique_ptr<FrameDecoder> decode_video(const std::filesystem::path& path, const core::Warn& warn);

/// Images, one a frame: 8-bit, or 16-bit with white at 2^b − 1, b the bits that the largest value of all
/// files needs (at least 8; finding it reads every file once). Alpha is dropped, with one warning. The first
/// file tells size, depth and channels; grey files in a colour clip are spread to three channels.
/// core::IoError, naming the file: unreadable, cut off, of another size or depth than the first, colour in a
/// grey clip (unless `to_grey`, which turns every file to luma).
std::unique_ptr<FrameDecoder> decode_images(std::vector<std::filesystem::path> files, bool to_grey,
                                            const core::Warn& warn);

/// A clip in memory.
std::unique_ptr<FrameDecoder> decode_clip(core::Clip clip);

/// Rec. 601 luma of a CV_8U or CV_16U frame, in its own depth; a grey frame is returned as it is.
cv::Mat to_grey(const cv::Mat& frame);

}  // namespace emberfold::io
