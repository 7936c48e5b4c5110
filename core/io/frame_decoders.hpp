// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Decodes a clip as stored, before levels, range, scale and the like are applied; `white` in info() is the
/// largest value of 8 and 16 bits, and 1 for floats.
class FrameDecoder : public core::FrameSource {
 public:
  /// Skips one frame, as cheaply as the format allows. Returns false after the last.
  virtual bool skip() = 0;
};

/// Opens a video that FFmpeg decodes: CV_8U, rotated by its rotation flag; one channel where the stream
/// itself is grey. `info().frames` is what the container claims until the end was reached once, then the
/// number read. Throws core::IoError: no such file, no video, no frame that can be decoded, frames that
/// change size. A file that ends before its container claims (by two frames or more) is used as far as it
/// goes, with a warning. Where frames are not evenly spaced in time and no rate is given, `info().times` has
/// the time of each, up to the end of the range, with a warning. Pixels that are not square stay as stored,
/// with a warning.
std::unique_ptr<FrameDecoder> decode_video(const std::filesystem::path& path, const ReadOptions& options,
                                           const core::Warn& warn);

/// Opens images, one a frame, of 8 bits, 16 bits or floats (TIFF). Drops alpha, takes the first page of a
/// TIFF with several, and of several grey samples a pixel the first or that of options.channel, each with one
/// warning; also warns of numbers missing in the files' names. The first file sets size, depth, channels and
/// the size of a pixel; grey files in a colour clip are spread to three channels. Throws core::IoError,
/// naming the file: unreadable, cut off, of another size or depth than the first, colour in a grey clip
/// (unless options.grey, which turns every file to luma). Floats may be non-finite. Throws core::InputError
/// where a slice is requested.
std::unique_ptr<FrameDecoder> decode_images(std::vector<std::filesystem::path> files,
                                            const ReadOptions& options, const core::Warn& warn);

/// Opens a TIFF: its pages, one a frame, or those of the requested channel and slice where ImageJ, OME or
/// tifffile describe them, or pixels have several samples. Warns of channels and slices chosen by default, of
/// oddities in the metadata, of values that are not plain brightness (docs/formats.md), of smaller copies and
/// masks, which are skipped, and of frames missing at the end. Pages have 1 or 3 channels of 8 bits, 16 bits
/// or floats (CV_32F; doubles are converted). Throws core::IoError, naming the file and page: no whole page,
/// damaged, of another size or kind than the first; core::InputError for a channel or slice that it does not
/// have.
std::unique_ptr<FrameDecoder> decode_tiff(const std::filesystem::path& path, const ReadOptions& options,
                                          const core::Warn& warn);

/// Throws core::InputError where options ask for a slice: for clips that have none.
void refuse_slices(const std::filesystem::path& path, const ReadOptions& options);

/// Opens a clip in memory.
std::unique_ptr<FrameDecoder> decode_clip(core::Clip clip);

/// Converts a frame to Rec. 601 luma in its own depth; a grey frame is returned unchanged.
cv::Mat to_grey(const cv::Mat& frame);

}  // namespace emberfold::io
