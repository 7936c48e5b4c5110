// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/quilting/control.hpp"
#include "core/io/clip_reader.hpp"
#include "dytex/quilting/quilt.hpp"

namespace emberfold::apps {

/// What `emberfold quilt` was asked for.
struct QuiltRequest {
  std::vector<std::string> clips;  ///< the time-lapse, and others beside it
  io::ReadOptions read;
  std::string output;  ///< a folder for everything, or the clip's own name: .mp4, .avi, .png
  std::string map;     ///< where the map goes besides; empty: map.npy beside the clip
  std::string apply;   ///< a map: nothing is sought
  std::string format;  ///< of the clip in a folder: mp4, avi, png; empty: what fits

  dytex::QuiltOptions quilt;
  bool own_size = false, own_block = false, own_overlap = false, own_apart = false;
  std::vector<std::string> masks;  ///< one for each clip, or for the first ones
  std::string guide;
  double flatten = 0;  ///< px, 0: not

  ControlRequest control;
  std::optional<std::int64_t> frames;  ///< of the output; as many as the source has
  std::optional<std::int64_t> frame;   ///< only this one
  bool resume = false;
  int memory = 1024;  ///< MB, for clips before they go into a file
};

/// "1024x768", or "512" for a square; Misuse, naming `option`, for anything else.
cv::Size parse_size(const std::string& option, const std::string& text);

/// Size, block, overlap and apart that follow from a source of this size where they were not asked for: twice
/// the source, at most half of its shorter side, a quarter and half of the block's.
void complete_request(QuiltRequest& request, cv::Size source);

/// Checks all that can be checked before a clip is opened; Misuse.
void check_request(const QuiltRequest& request);

/// The options as summary.json has them.
nlohmann::ordered_json request_json(const QuiltRequest& request);

}  // namespace emberfold::apps
