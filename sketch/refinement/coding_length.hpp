// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/detection/colour.hpp"

namespace emberfold::sketch {

/// Holds a frame prepared for code_patch: its luma and the amount of noise in it.
struct CodingContext {
  cv::Mat1f luma;                         ///< white = 255; or another mixture of the channels
  std::array<float, 3> axis = kLumaAxis;  ///< its weights of blue, green and red
  double noise = 1;  ///< grey levels, SD of the pixels about a local plane, median over the frame; ≥ 0.29
  /// Noise correlation factors, ≥ 1: by how much more than on white noise a contrast varies, 5 px along and
  /// across a bar of 3 or 6 px.
  std::array<double, 2> noise_correlation = {1, 1};
};

/// Prepares a frame. `levels`: CV_32F, 1 or 3 channels, white = 255, finite; throws core::InputError
/// otherwise. O(pixels).
CodingContext prepare_coding(const cv::Mat& levels);
/// Prepares another mixture of the channels, of these weights.
CodingContext prepare_coding(cv::Mat1f mixture, const std::array<float, 3>& axis);

/// Holds the cost and the gain of a patch of a frame, nats.
struct Coding {
  double cost = 0, gain = 0;
};

/// Computes the cost of a patch and its gain in coding length over the fill, nats.
/// The gain is that of drawing `patch` rather than leaving its place to the fill. Guo, Zhu & Wu 2007, whose
/// image is the drawn patches plus white noise:
///   Σ w·[(I − g)² − (I − profile)²] / (2 noise² noise_correlation) − cost
/// over the patch's footprint, 5 px along it and, to each side, as far as draw_fitted shows its profile, at
/// least 3 px. g stands for the fill: an even ramp as steep as the difference between the bands that lie
/// outside the footprint on both sides, at the level that suits the footprint best. The noise correlation is
/// that of a bar of the patch's size.
///
/// The cost is ½·ln(1 + n) nats for each number that the patch has and the ramp has not (7 of a line, 5 of a
/// step), n the footprint's pixels ÷ noise_correlation: the precision at which the pixels determine them
/// (Rissanen's description length). Pixels outside the frame do not count: a patch outside it gains and costs
/// nothing. Patches fitted at places of chance gain more than 0 less than once in 1000 times in white noise,
/// once in 100 in noise that is smooth over 1.6 px. O(pixels of footprint and bands); thread-safe.
Coding code_patch(const CodingContext& frame, const graph::Patch& patch);

/// Returns the gain alone.
inline double coding_gain(const CodingContext& frame, const graph::Patch& patch) {
  return code_patch(frame, patch).gain;
}

}  // namespace emberfold::sketch
