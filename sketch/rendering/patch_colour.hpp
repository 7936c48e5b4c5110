// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "core/math/luma.hpp"
#include "graph/patch.hpp"

namespace emberfold::sketch::detail {

using Colour = std::array<double, 3>;

/// Returns a level of a patch as a frame of 3 channels has it; of 1, its luma and two zeros.
inline Colour colour(const graph::Level& level, int channels) {
  const Colour c = {double{level[0]}, double{level[1]}, double{level[2]}};
  return channels == 3 ? c : Colour{core::luma(c[0], c[1], c[2]), 0, 0};
}

}  // namespace emberfold::sketch::detail
