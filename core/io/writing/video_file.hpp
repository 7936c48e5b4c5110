// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core/types.hpp>

#include "core/io/clip_writer.hpp"

namespace emberfold::io {

/// Creates the writer of an .mp4 (H.264) or else an .avi (FFV1); see create_video().
std::unique_ptr<VideoWriter> create_video_file(const std::filesystem::path& path, bool mp4, cv::Size size,
                                               double fps, bool colour);

}  // namespace emberfold::io
