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
  std::vector<std::string> clips;  ///< the time-lapse, and additional clips
  io::ReadOptions read;
  std::string output;  ///< a folder for everything, or a clip file: .mp4, .avi, .png
  std::string apply;   ///< a map to apply; no search
  std::string format;  ///< of the clip in a folder: mp4, avi, png; empty: chosen automatically

  dytex::QuiltOptions quilt;
  bool own_size = false, own_block = false, own_overlap = false;
  std::vector<std::string> masks;  ///< one for each clip, or for the first ones
  std::string guide;
  std::string surface;          ///< a mesh (OBJ) whose texture the output becomes; empty: a plane
  std::string seams = "still";  ///< or moving
  double flatten = 0;           ///< px, 0: off

  ControlRequest control;
  std::optional<std::int64_t> frames;  ///< of the output; default: that of the source
  std::optional<std::int64_t> frame;   ///< only this frame
  int memory = 1024;                   ///< MB, above which clips are kept in a file
};

/// Parses "1024x768", or "512" for a square. Throws Misuse naming `option` for other texts.
cv::Size parse_size(const std::string& option, const std::string& text);

/// Derives missing values from the source's size: size (twice the source, 1024x1024 for a surface), block (at
/// most half of its shorter side), overlap and apart (a quarter and half of the block).
void complete_request(QuiltRequest& request, cv::Size source);

/// Checks everything that can be checked before a clip is opened. Throws Misuse.
void check_request(const QuiltRequest& request);

/// Writes the options for summary.json.
nlohmann::ordered_json request_json(const QuiltRequest& request);

}  // namespace emberfold::apps
