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

/// The output of a quilt: a folder with everything, or a clip file with the map next to it.
struct QuiltTarget {
  bool whole = true;  ///< a folder with pictures and report
  std::filesystem::path folder;
  std::string clip;     ///< its name in the folder
  bool single = false;  ///< a single PNG

  [[nodiscard]] std::filesystem::path path() const { return folder / clip; }
};

/// Chooses the output. Throws core::IoError where the clip's folder does not exist.
QuiltTarget quilt_target(const QuiltRequest& request);

/// Names the clip once its depth and length are known. Throws Misuse where its format cannot hold it.
void name_clip(QuiltTarget& target, const QuiltRequest& request, const core::ClipInfo& info,
               std::int64_t frames);

/// Returns whether the rendered map already is the file map.npy of the output, which then stays unchanged.
bool keeps_map(const QuiltRequest& request, const QuiltTarget& target);

/// Writes map.npy, or the file that the request names, and time.npy where times differ between places.
void write_quilt_map(io::OutputFolder& output, const QuiltRequest& request, const QuiltTarget& target,
                     const dytex::QuiltMap& map, const dytex::TimeControl& control);

/// A drawn frame, CV_8UC3.
struct QuiltedFrame {
  int frame = 0;
  cv::Mat picture;
};

/// The frames of the output to draw.
struct FramePlan {
  std::int64_t first = 0, count = 0;
  bool to_end = false;  ///< fewer where the clip is shorter than its header says
};

/// The length of a written clip and some of its frames.
struct WrittenClip {
  std::int64_t frames = 0;
  std::vector<QuiltedFrame> some;  ///< the first, the middle and the last
};

/// Draws and writes the clip. Throws core::Cancelled.
WrittenClip write_quilt_clip(io::OutputFolder& output, const QuiltTarget& target, const dytex::QuiltMap& map,
                             const QuiltClips& clips, const dytex::TimeControl& control,
                             const FramePlan& plan, Session& session);

}  // namespace emberfold::apps
