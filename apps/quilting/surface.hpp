// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/cli/command.hpp"
#include "apps/quilting/request.hpp"
#include "dytex/surface/surface_quilt.hpp"

namespace emberfold::apps {

/// A surface that a quilt is laid over, and the quilt once it is.
struct SurfaceFound {
  dytex::SurfaceLayout layout;
  dytex::SurfaceQuilt quilt{};
};

/// Reads the request's mesh and lays its texture out; warns of charts without a texel and of texels that show
/// several places. Throws core::IoError or core::InputError with its name.
SurfaceFound read_surface(const QuiltRequest& request, Session& session);

/// Returns a number that differs between layouts.
std::string surface_fingerprint(const dytex::SurfaceLayout& layout);

/// Returns a map in which only texels of two blocks do not continue each other.
dytex::QuiltMap block_map(const SurfaceFound& found);

/// Writes what is known of a surface for summary.json.
nlohmann::ordered_json surface_json(const std::string& mesh, const dytex::SurfaceLayout& layout);

/// Writes how visible seams and glued edges are, for summary.json.
nlohmann::ordered_json surface_measures_json(const SurfaceFound& found,
                                             std::span<const dytex::Trajectories* const> sources);

}  // namespace emberfold::apps
