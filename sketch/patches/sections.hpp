// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <opencv2/core/mat.hpp>

#include "sketch/patches/profile.hpp"
#include "sketch/patches/profile_model.hpp"

namespace emberfold::sketch {

/// Mean variance of the weights between two pixels, px², which sections show as blur.
inline constexpr double kInterpolationVariance = 1.0 / 6;

/// Holds the image across a patch as means over its ribs.
/// There is one for each of the frame's channels, and one for luma or another axis of colour.
struct Sections {
  std::array<Section, 3> channel;
  Section seen;
};

/// Returns the variance of a section's sample in noise of this SD. Neighbouring samples share half of it,
/// hence twice the independent one.
double section_variance(std::span<const Rib> ribs, double noise);

/// Samples the image across a patch. `levels`: CV_32F, 1 or 3 channels, continued beyond the frame by its
/// border. `ribs`: not empty. `count`: number of samples, ≤ kMostSamples. `axis`: the weights of blue, green
/// and red in the mixture.
Sections sample_sections(const cv::Mat& levels, std::span<const Rib> ribs, std::size_t count,
                         const std::array<float, 3>& axis);

}  // namespace emberfold::sketch
