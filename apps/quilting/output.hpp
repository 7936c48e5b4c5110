// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/quilting/request.hpp"
#include "apps/quilting/write.hpp"
#include "core/io/staged_output.hpp"

namespace emberfold::apps {

/// The place of a quilt: a folder with everything, or a clip's own name with the map beside it.
struct QuiltTarget {
  bool whole = true;  ///< a folder with pictures and report
  std::filesystem::path folder;
  std::string clip;     ///< its name in the folder
  bool single = false;  ///< it is one PNG
  std::filesystem::path checkpoint;

  [[nodiscard]] std::filesystem::path path() const { return folder / clip; }
};

/// Chooses the place. Throws core::IoError where the clip's folder does not exist.
QuiltTarget quilt_target(const QuiltRequest& request);

/// Names the clip once its depth and length are known. Throws Misuse where its format cannot hold it.
void name_clip(QuiltTarget& target, const QuiltRequest& request, const core::ClipInfo& info,
               std::int64_t frames);

/// Tells whether the map that is rendered lies where map.npy would be written; it then stays as it is.
bool keeps_map(const QuiltRequest& request, const QuiltTarget& target);

/// Writes map.npy, or the request's own name for it, and time.npy where times differ from place to place.
void write_quilt_map(io::OutputFolder& output, const QuiltRequest& request, const QuiltTarget& target,
                     const dytex::QuiltMap& map, const dytex::TimeControl& control);

/// A frame as drawn, CV_8UC3.
struct QuiltedFrame {
  int frame = 0;
  cv::Mat picture;
};

/// The frames of the output to draw.
struct FramePlan {
  std::int64_t first = 0, count = 0;
  bool to_end = false;  ///< fewer where the clip is shorter than it tells
};

/// The length of a written clip and some of its frames.
struct WrittenClip {
  std::int64_t frames = 0;
  std::vector<QuiltedFrame> some;  ///< the first, the middle and the last one
};

/// Draws and writes the clip. Throws core::Cancelled.
WrittenClip write_quilt_clip(io::OutputFolder& output, const QuiltTarget& target, const dytex::QuiltMap& map,
                             const QuiltClips& clips, const dytex::TimeControl& control,
                             const FramePlan& plan, Session& session);

}  // namespace emberfold::apps
