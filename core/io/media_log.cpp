// SPDX-License-Identifier: Apache-2.0
#include "core/io/media_log.hpp"

#include <cstdlib>

#include <opencv2/core/utils/logger.hpp>

namespace emberfold::io {

void silence_media_libraries() {
  static const bool once = [] {
    if (std::getenv("OPENCV_LOG_LEVEL") == nullptr)
      cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    // OpenCV hands this to av_log_set_level when FFmpeg is first used, and offers no call for it; −8 is
    // AV_LOG_QUIET.
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace emberfold::io
