// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Removes the lines that stronger lines of the opposite sign explain as their counter-lobes. A Gaussian line
/// of SD s and height h, seen at scale σ, has beside it the counter-lobe h·s·S⁻³·(d²/S² − 1)·exp(−d²/2S²), S²
/// = s² + σ²; between two lines such lobes add up. The strongest lines are judged first, and a removed line
/// explains nothing; at the end all lines that stay are judged once more. Lines that show at their own scale
/// only, where the ground is flat, are removed too. Order is kept.
std::vector<Chain> remove_lobe_curves(std::vector<Chain> chains, const ScaleSpace& space, cv::Size frame);

}  // namespace emberfold::sketch
