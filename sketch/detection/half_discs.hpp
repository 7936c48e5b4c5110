// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

/// Directions in which half discs are compared: way i runs along the angle i·π/8 of x towards y.
inline constexpr int kDiscWays = 8;

/// Holds how much each pixel belongs to each bin of a histogram, in 255ths; a map for each bin.
using SoftBins = std::vector<cv::Mat1b>;

/// Sorts values into `bins` bins from `low` to `high`: each value belongs to those near it, by a Gaussian of
/// SD `spread` bins. `values`: CV_32F, one channel; what lies outside counts as `low` or `high`.
SoftBins soft_bins(const cv::Mat1f& values, double low, double high, int bins, double spread);

/// Adds to each map (one a way, each as large as the frame) `weight` times the χ² distance, 0…1, between the
/// histograms of the two half discs of `radius` px beside a pixel, parted along the way. Sums are whole
/// numbers, so that mirrored frames have the same. Martin, Fowlkes & Malik 2004. O(pixels · bins · radius).
void add_half_disc_distances(const SoftBins& bins, int radius, float weight, std::vector<cv::Mat1f>& maps);

}  // namespace emberfold::sketch
