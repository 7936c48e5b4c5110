// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <opencv2/core/mat.hpp>

#include "sketch/patches/profile.hpp"
#include "sketch/patches/profile_model.hpp"

namespace emberfold::sketch {

/// px²: the variance that weights between two pixels have on the mean, which sections show as blur.
inline constexpr double kInterpolationVariance = 1.0 / 6;

/// The image across a patch: means over its ribs, of each of the frame's channels and of luma or another axis
/// of colour.
struct Sections {
  std::array<Section, 3> channel;
  Section seen;
};

/// The variance of a section's sample in noise of this SD: neighbouring samples share half of it, twice
/// counts.
double section_variance(std::span<const Rib> ribs, double noise);

/// `levels`: CV_32F, 1 or 3 channels; beyond the frame they are those of its border. `ribs`: not empty.
/// `count`: of samples, ≤ kMostSamples. `axis`: the weights of blue, green and red by which it is seen.
Sections sample_sections(const cv::Mat& levels, std::span<const Rib> ribs, std::size_t count,
                         const std::array<float, 3>& axis);

}  // namespace emberfold::sketch
