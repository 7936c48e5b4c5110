// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::io {

/// Silences the log lines of OpenCV and FFmpeg on stderr for the rest of the process. Failures are reported
/// by exceptions instead. Keeps a log level that the user has set in the environment (OPENCV_LOG_LEVEL,
/// OPENCV_FFMPEG_LOGLEVEL). Call before the first clip is opened; later calls cost nothing.
void silence_media_libraries();

}  // namespace emberfold::io
