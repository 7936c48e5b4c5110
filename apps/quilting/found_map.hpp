// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/quilting/inputs.hpp"
#include "apps/quilting/surface.hpp"

namespace emberfold::apps {

/// The map of a quilt, and how it was found.
struct FoundMap {
  dytex::QuiltMap map;
  std::optional<dytex::QuiltResult> result;  ///< of a search for a plane
  std::optional<SurfaceFound> surface;       ///< of a search for a surface
};

/// Searches for the map of a plane, or of found.surface. Throws core::Cancelled.
void seek_map(FoundMap& found, const QuiltClips& clips, const QuiltRequest& request, const Session& session);

/// Reads a map whose places are in clips of these sizes. Throws core::IoError or core::InputError with its
/// name.
dytex::QuiltMap read_map(const std::string& name, const std::vector<cv::Size>& sizes);

/// Writes the figures of a map for summary.json; the visibility of seams only for loaded clips.
nlohmann::ordered_json found_map_json(const FoundMap& found, const QuiltClips& clips);

}  // namespace emberfold::apps
