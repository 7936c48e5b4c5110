// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::io {

/// Keeps OpenCV's and FFmpeg's own log lines off stderr, from here on and for the whole process; what goes
/// wrong is told by our errors instead. Does nothing about a log level that the user has set in the
/// environment (OPENCV_LOG_LEVEL, OPENCV_FFMPEG_LOGLEVEL). Call before the first clip is opened; later calls
/// cost nothing.
void silence_media_libraries();

}  // namespace emberfold::io
