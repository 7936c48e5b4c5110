// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::io {

/// Writes a clip frame by frame under a temporary name. finish() renames it once it is complete; without
/// finish() the destructor removes it.
class VideoWriter {
 public:
  VideoWriter() = default;
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  virtual ~VideoWriter() = default;

  /// Writes a frame of the clip's size: CV_8UC1 or CV_8UC3. A grey frame in a colour clip is spread to three
  /// channels. A folder of pictures also takes CV_16U and a fourth channel, the opacity (not multiplied into
  /// the colours), one of EXR also CV_32F: linear light, colours multiplied by their opacity. Throws
  /// core::InputError for any other frame, core::IoError where the disk refuses it.
  virtual void write(const cv::Mat& frame) = 0;

  /// Completes the clip and gives it its name. Throws core::InputError where no frame was written;
  /// core::IoError, with nothing left behind, where the file is incomplete (a full disk). Nothing can be
  /// written afterwards.
  virtual void finish() = 0;
};

/// Creates a writer by the extension of the name:
///   .mp4          H.264, yuv420p, plays in a browser
///   .avi          FFV1: lossless, 8 bits, grey or colour
///   no extension  a folder of PNG, frame_00000.png …, 8 or 16 bits
///   DIR/N%05d.png the same with other names
///   DIR/N%05d.exr a folder of OpenEXR, half floats; 8 and 16 bits (sRGB) become linear light
/// Videos have even sizes: an odd width or height repeats its last column or row. A folder of that name is
/// replaced if it holds nothing but such frames, else refused. size: 1…16384 px each way; fps: (0, 1e6]; a
/// video of fewer than 1 or more than 1000 frames a second is stored at 25, one of 29.97 and the like at
/// 30000/1001. Throws core::InputError for another extension, size or rate, core::IoError where the target
/// cannot be written.
std::unique_ptr<VideoWriter> create_video(const std::filesystem::path& path, cv::Size size, double fps,
                                          bool colour);

/// Returns whether the clip of this name becomes a folder of pictures. Throws core::InputError for
/// a pattern that create_video() refuses.
bool is_frame_folder(const std::filesystem::path& path);

/// Writes the next `frames` frames of a source (CV_8U) as create_video() does, fewer where it ends earlier.
/// core::InputError for a source of another depth or without a frame; throws core::Cancelled.
void write_video(const std::filesystem::path& path, core::FrameSource& source, int frames,
                 const core::Context& context = {});

}  // namespace emberfold::io
