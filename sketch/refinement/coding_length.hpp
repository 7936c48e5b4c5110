// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/detection/colour.hpp"

namespace emberfold::sketch {

/// A frame, prepared for coding_gain: its luma and how much of it is noise.
struct CodingContext {
  cv::Mat1f luma;                         ///< white = 255; or another mixture of the channels
  std::array<float, 3> axis = kLumaAxis;  ///< its weights of blue, green and red
  double noise = 1;  ///< grey levels, SD of the pixels about a local plane, median over the frame; ≥ 0.29
  /// ≥ 1: how much more a contrast of 5 px along and a bar of 3 or 6 px across varies than on white noise.
  std::array<double, 2> noise_correlation = {1, 1};
};

/// `levels`: CV_32F, 1 or 3 channels, white = 255, finite; InputError otherwise. O(pixels).
CodingContext prepare_coding(const cv::Mat& levels);
/// The same for another mixture of the channels, of these weights.
CodingContext prepare_coding(cv::Mat1f mixture, const std::array<float, 3>& axis);

/// ½·ln(1 + pixels) nats for each number of the patch that the fill has not: 7 of a line, 9 of a double
/// ridge, 5 of a step, 6 of a blob. `pixels`: > 0, those that tell the numbers, independent of each other.
double coding_cost(const graph::Patch& patch, double pixels);

/// What a patch of a frame costs and gains, nats.
struct Coding {
  double cost = 0, gain = 0;
};

/// The gain in coding length, nats, of showing `patch` in the frame rather than leaving its place to the fill
/// (Guo, Zhu, Wu 2007, whose image is the drawn patches plus white noise):
///   Σ w·[(I − g)² − (I − profile)²] / (2 noise² noise_correlation) − cost
/// over the patch's footprint, 5 px along it and, to each side, as far as draw_fitted shows its profile, at
/// least 3 px. g is what the fill would show: an even ramp as steep as the difference between the bands that
/// lie outside the footprint on both sides, at the level that suits the footprint best. `noise_correlation`
/// is that of a bar of the patch's size. The cost is ½·ln(1 + n) nats for each number that the patch has and
/// the ramp has not (coding_cost), n the footprint's pixels ÷ noise_correlation: the precision at which the
/// pixels tell them (Rissanen's description length). A blob gains over the best ramp in its disc. Pixels
/// outside the frame are not there: a patch outside it gains and costs nothing. Patches fitted at places of
/// chance gain more than 0 less than once in 1000 times in white noise, once in 100 in noise that is smooth
/// over 1.6 px. O(pixels of footprint and bands); thread-safe.
Coding code_patch(const CodingContext& frame, const graph::Patch& patch);

/// Its gain alone.
inline double coding_gain(const CodingContext& frame, const graph::Patch& patch) {
  return code_patch(frame, patch).gain;
}

}  // namespace emberfold::sketch
