// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

/// Polygons as triangles. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// Cuts a polygon of n ≥ 3 corners into n − 2 triangles of their indices: a convex one from its first corner,
/// others ear by ear. A polygon that crosses itself, or has no area, is cut arbitrarily. O(n³) at most.
std::vector<std::array<std::size_t, 3>> cut_polygon(std::span<const cv::Point2d> corners);

}  // namespace emberfold::dytex::detail
