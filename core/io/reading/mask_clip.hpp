// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Reads the mask of a clip, as large as the clip is stored: an image, which counts for every frame, or a
/// clip of that number of frames. MaskSource says which pixels count.
class MaskClip {
 public:
  /// `options`: of the clip; the frames are those that it takes. Throws core::IoError where it cannot be
  /// read, core::InputError where it has another size, or nothing in it counts. Warns where its first frame
  /// holds many values: labels, or a picture that is no mask.
  MaskClip(const ReadOptions& options, cv::Size size, const core::Warn& warn = {});
  /// Returns the next frame's mask, CV_8U, 255 where structure counts. core::InputError after the last.
  cv::Mat next();
  void rewind();

 private:
  std::string name_;
  std::unique_ptr<core::FrameSource> source_;
  cv::Mat only_;  ///< of an image

  cv::Mat read();
};

}  // namespace emberfold::io
