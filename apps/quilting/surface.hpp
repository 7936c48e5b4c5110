// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/cli/command.hpp"
#include "apps/quilting/request.hpp"
#include "dytex/surface/surface_quilt.hpp"

namespace emberfold::apps {

/// A surface on which a quilt is laid, and the quilt once it is found.
struct SurfaceFound {
  dytex::SurfaceLayout layout;
  dytex::SurfaceQuilt quilt{};
};

/// Reads the request's mesh and lays its texture out; warns of charts without texels and of texels that show
/// several places. Throws core::IoError or core::InputError with its name.
SurfaceFound read_surface(const QuiltRequest& request, Session& session);

/// Returns a map in which only texels of different blocks are discontinuous.
dytex::QuiltMap block_map(const SurfaceFound& found);

/// Returns the description of a surface for summary.json.
nlohmann::ordered_json surface_json(const std::string& mesh, const dytex::SurfaceLayout& layout);

/// Returns the visibility of seams and glued edges, for summary.json.
nlohmann::ordered_json surface_measures_json(const SurfaceFound& found,
                                             std::span<const dytex::Trajectories* const> sources);

}  // namespace emberfold::apps
