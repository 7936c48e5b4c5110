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

/// The request of `emberfold quilt`.
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
  std::string surface;          ///< a mesh (OBJ) whose texture the output becomes; empty: a plane
  double pixel = 0;             ///< size of the clip's pixel on the surface, in the mesh's unit; 0: a texel's
  std::string seams = "still";  ///< or moving
  double flatten = 0;           ///< px, 0: not

  ControlRequest control;
  std::optional<std::int64_t> frames;  ///< of the output; as many as the source has
  std::optional<std::int64_t> frame;   ///< only this one
  bool resume = false;
  int memory = 1024;  ///< MB, for clips before they go into a file
};

/// Parses "1024x768", or "512" for a square. Throws Misuse naming `option` for another text.
cv::Size parse_size(const std::string& option, const std::string& text);

/// Sets what was not given from the source's size: size (twice the source, 1024x1024 of a surface), block (at
/// most half of its shorter side), overlap and apart (a quarter and half of the block).
void complete_request(QuiltRequest& request, cv::Size source);

/// Checks all that can be checked before a clip is opened. Throws Misuse.
void check_request(const QuiltRequest& request);

/// Writes the options for summary.json.
nlohmann::ordered_json request_json(const QuiltRequest& request);

}  // namespace emberfold::apps
