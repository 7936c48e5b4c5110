// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/context.hpp"
#include "dytex/quilting/quilt.hpp"
#include "dytex/surface/surface_layout.hpp"

namespace emberfold::dytex {

struct SurfaceQuilt {
  QuiltMap map;  ///< of the whole texture; beyond the charts the pixels that a look-up may meet
  std::vector<std::int32_t>
      blocks;  ///< the block that each texel shows, by its place in `choices`; −1: beyond
  std::vector<QuiltChoice> choices;  ///< in the order in which they were placed; column is that place, row 0
  int components = 0;                ///< of the basis; 0 where whole trajectories are compared
};

/// Image quilting on a surface. Blocks have the same size everywhere on the surface: each is laid flat by the
/// mean stretch of the texels it covers. Chart after chart, the largest first, a block is placed where texels
/// are empty, overlapping earlier blocks by `overlap`; it is chosen as in quilt(), by all it meets in its
/// chart and up to `overlap` beyond glued edges, and joined within its chart along a minimum cut. Then blocks
/// of half that size join both sides of glued edges to each other, where they fit better than the existing
/// pixels. Nothing is turned in the texture: normals in the tangent space of the texture stay right. Texels
/// of no chart copy the surface beyond the nearest glued edge, up to 8 texels away, then the nearest of a
/// chart.
///
/// `options.size` must be the layout's. Throws InputError as quilt() does, and for options.tileable
/// and Seams::moving. The same result at any thread count.
/// O(blocks · (k · pixels + compared · overlap · frames)).
SurfaceQuilt quilt_surface(const SurfaceLayout& layout, std::span<const QuiltSource> sources,
                           const QuiltOptions& options, const core::Context& context = {});

}  // namespace emberfold::dytex
