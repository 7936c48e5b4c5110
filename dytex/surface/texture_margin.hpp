// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dytex/quilting/quilt_map.hpp"
#include "dytex/surface/surface_layout.hpp"

/// What lies beyond charts. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// Fills the texels of no chart: up to 8 texels from a glued edge what the surface goes on with there, else
/// what the nearest texel of a chart has. O(texels + length of the edges).
void fill_margin(const SurfaceLayout& layout, QuiltMap& map);

}  // namespace emberfold::dytex::detail
