// SPDX-License-Identifier: Apache-2.0
#include "core/io/media_log.hpp"

#include <cstdlib>

extern "C" {
#include <libavutil/log.h>
}

#include <opencv2/core/utils/logger.hpp>

namespace emberfold::io {

void silence_media_libraries() {
  static const bool once = [] {
    if (std::getenv("OPENCV_LOG_LEVEL") == nullptr)
      cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    av_log_set_level(AV_LOG_QUIET);
    // OpenCV hands this to av_log_set_level when it first uses FFmpeg, and offers no call for it.
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace emberfold::io
