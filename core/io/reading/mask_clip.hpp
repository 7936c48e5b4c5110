// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::io {

/// Reads the mask of a clip, of the clip's stored size: an image, used for every frame, or a clip with the
/// same number of frames. MaskSource defines which pixels count.
class MaskClip {
 public:
  /// `options`: the clip's; they select the frames. Throws core::IoError where it cannot be read,
  /// core::InputError where it has another size, or nothing in it counts. Warns where its first frame holds
  /// many values: labels, or a picture that is not a mask.
  MaskClip(const ReadOptions& options, cv::Size size, const core::Warn& warn = {});
  /// Returns the next frame's mask, CV_8U, 255 where structure counts. Throws core::InputError after the
  /// last.
  cv::Mat next();
  void rewind();

 private:
  std::string name_;
  std::unique_ptr<core::FrameSource> source_;
  cv::Mat only_;  ///< of an image

  cv::Mat read();
};

}  // namespace emberfold::io
