// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Drops the lines that stronger ones of the opposite sign explain: a Gaussian line of SD s and height h,
/// seen at scale σ, has beside it the counter-lobe h·s·S⁻³·(d²/S² − 1)·exp(−d²/2S²), S² = s² + σ²; between
/// two lines such lobes add up. The strongest lines come first; a dropped line explains nothing; at the end
/// all that stay judge each other once more. Lines that exist at their own scale only, where the ground is
/// flat, go too. Order is kept.
std::vector<Chain> remove_lobe_curves(std::vector<Chain> chains, const ScaleSpace& space, cv::Size frame);

}  // namespace emberfold::sketch
