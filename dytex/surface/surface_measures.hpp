// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dytex/surface/surface_quilt.hpp"

namespace emberfold::dytex {

/// Figures of a quilt on a surface: how visible seams between blocks, and glued edges of charts, are. Steps
/// are mean sizes in levels of 255, over time and channels.
struct SurfaceMeasures {
  double seam_share = 0;   ///< share of neighbouring texels of one chart that are of two blocks
  double seam_step = 0;    ///< the step between these
  double other_step = 0;   ///< the step between all others of one chart
  double border_step = 0;  ///< the step between points half a source pixel to either side of a glued edge
  double border_gap = 0;   ///< between bilinear look-ups of a point on a glued edge from its two sides
  std::int64_t border_places = 0;  ///< at which glued edges were measured, a source pixel apart
  double source_share = 0;         ///< share of the source pixels that show somewhere
  /// Returns seam_step / other_step; 1 where there are no seams, or nothing steps anywhere.
  [[nodiscard]] double seam_ratio() const;
  /// Returns border_step / other_step in the same way.
  [[nodiscard]] double border_ratio() const;
};

/// Measures a quilt of a surface over at most `frames` frames, spread evenly.
SurfaceMeasures measure_surface(const SurfaceLayout& layout, const SurfaceQuilt& quilt,
                                std::span<const Trajectories* const> sources, int frames = 32);

}  // namespace emberfold::dytex
