// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dytex/quilting/quilt_map.hpp"
#include "dytex/surface/surface_layout.hpp"

/// The texture beyond charts. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// Fills the texels of no chart: up to 8 texels from a glued edge with the continuation of the surface, else
/// with the pixel of the nearest texel of a chart. O(texels + length of the edges).
void fill_margin(const SurfaceLayout& layout, QuiltMap& map);

}  // namespace emberfold::dytex::detail
