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

/// Decodes a clip as it is stored, before range, scale and grey are applied.
class FrameDecoder : public core::FrameSource {
 public:
  /// Skips one frame, as cheaply as the format allows. Returns false after the last.
  virtual bool skip() = 0;
};

/// Opens a video that FFmpeg decodes: CV_8U, turned as its rotation flag tells; one channel where the stream
/// itself is grey. `info().frames` is what the container claims until the end was reached once, then what was
/// read. Throws core::IoError: no such file, no video, no frame that can be decoded, frames that change size.
/// A file that ends before its container claims (by two frames or more) is used as far as it goes, with a
/// warning.
std::unique_ptr<FrameDecoder> decode_video(const std::filesystem::path& path, const core::Warn& warn);

/// Opens images, one a frame: 8-bit, or 16-bit with white at 2^b − 1, b the bits that the largest value of
/// all files needs (at least 8; finding it reads every file once). Alpha is dropped, and of a TIFF with
/// several pages the first is taken, each with one warning. The first file tells size, depth and channels;
/// grey files in a colour clip are spread to three channels. Throws core::IoError, naming the file:
/// unreadable, cut off, of another size or depth than the first, colour in a grey clip (unless `to_grey`,
/// which turns every file to luma).
std::unique_ptr<FrameDecoder> decode_images(std::vector<std::filesystem::path> files, bool to_grey,
                                            const core::Warn& warn);

/// Opens a TIFF: its pages, one a frame, where it has several or holds floats; otherwise one image, as
/// decode_images does. Smaller copies and masks among the pages are passed over, with a warning. Pages have 1
/// or 3 channels (alpha is dropped, with a warning) of 8 bits, 16 bits or floats (CV_32F; doubles are
/// converted). White is 255 for 8 bits; for 16 bits 2^b − 1, b the bits that the largest value of all pages
/// needs (at least 8); for floats 1 where no value is above 1, otherwise as for 16 bits. Values of floats
/// below 0 stay. Finding white reads every page once. About 64 MiB of pages are kept. Throws core::IoError,
/// naming the file and page: cut off, damaged, of another size or kind than the first, a float that is not
/// finite.
std::unique_ptr<FrameDecoder> decode_tiff(const std::filesystem::path& path, bool grey,
                                          const core::Warn& warn);

/// Opens a clip in memory.
std::unique_ptr<FrameDecoder> decode_clip(core::Clip clip);

/// Converts a frame to Rec. 601 luma in its own depth; a grey frame is returned as it is.
cv::Mat to_grey(const cv::Mat& frame);

}  // namespace emberfold::io
