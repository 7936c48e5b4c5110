// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/fitted_frame.hpp"

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::io {

cv::Mat fitted_frame(const cv::Mat& frame, const FrameFormat& format, const std::filesystem::path& clip) {
  const auto refuse = [&](const std::string& what) { throw core::InputError(clip.string() + ": " + what); };
  if (frame.size() != format.size)
    refuse("a frame of " + core::size_text(frame.size()) + " pixels does not fit a clip of " +
           core::size_text(format.size));
  const int depth = frame.depth(), channels = frame.channels();
  if (depth != CV_8U && !(format.sixteen_bits && depth == CV_16U) && !(format.floats && depth == CV_32F))
    refuse("frames need " + format.depths);
  if (channels == 4 && !format.opacity) refuse("frames with opacity need a folder of PNG or EXR");
  if (channels != 1 && channels != 3 && channels != 4) refuse("frames need 1, 3 or 4 channels");
  if (channels == 3 && !format.colour) refuse("a frame in colour does not fit a grey clip");
  if (channels != 1 || !format.colour) return frame;
  cv::Mat spread;
  cv::cvtColor(frame, spread, cv::COLOR_GRAY2BGR);
  return spread;
}

void refuse_to_write(const std::filesystem::path& clip, const std::string& reason) {
  throw core::IoError("cannot write " + clip.string() + ": " + reason);
}

}  // namespace emberfold::io
