// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/patches/profile.hpp"

namespace emberfold::sketch {

inline constexpr double kWidestDouble = 20;  ///< px, of a double ridge

/// The numbers that fit_double_ridge() fits: all, or place and distance of the lines alone.
enum class DoubleFit { all, place };

/// Fits a double ridge (graph::Patch) near `start` by least squares; none where there is no such ridge.
/// Fitted are place, width, hollow and blur (with DoubleFit::place only place and distance of the lines: each
/// keeps its width and blur) and the levels in luma, by variable projection (Golub & Pereyra 1973) and
/// Levenberg-Marquardt. The levels of each channel suit that shape best. The blur keeps near the start's as
/// in fit_patch. None where the fit leaves its place, becomes wider than kWidestDouble, or does not show two
/// lines of the start's sign with a dip between them of a quarter of their contrast at least. `levels`:
/// CV_32F, 1 or 3 channels; `noise`: grey levels, SD of the pixels. Some 250 µs; `place` 170.
std::optional<graph::Patch> fit_double_ridge(const cv::Mat& levels, const graph::Patch& start,
                                             std::span<const Rib> ribs, double noise,
                                             DoubleFit fit = DoubleFit::all);

}  // namespace emberfold::sketch
