// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/noise_levels.hpp"
#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

/// Order of a derivative: the first shows steps, the second lines.
enum class Derivative : std::uint8_t { first, second };

/// Holds a derivative of a level across a direction, averaged along it, where that is most below and most
/// above 0: a weak curve shows by its length. Grey levels/px or /px².
struct OrientedResponse {
  cv::Mat1f negative, positive;  ///< ≥ 0: sizes of the derivatives; the second is negative on bright lines
  cv::Mat1b negative_way, positive_way;  ///< direction of that curve: number of `ways`
  cv::Mat1f across;                      ///< size of the response across the strongest direction
  cv::Mat1f ground;  ///< SD of the response where there is no curve, in cells of the frame; see ground_row()
  std::vector<graph::Point> ways;            ///< unit vectors u; derivatives are taken along (−u.y, u.x)
  std::vector<std::vector<cv::Point>> taps;  ///< of each way: the pixels ahead over which is averaged
  std::vector<float> weights;  ///< of the pixel itself and of its taps; twice their sum − the first = 1

  int reach = 0;  ///< px, of the farthest tap

  /// Writes the ground of row y of the frame, bilinear between cells. `row`: as wide as the frame.
  void ground_row(int y, std::vector<float>& row) const;
};

/// Adds every some-th value of a part's `across` to `samples`, together some 20,000 of a frame.
void sample_across(const cv::Mat1f& across, const FramePart& part, std::vector<float>& samples);
/// Returns what is usual of them: their median. At least one.
double usual_response(std::vector<float> samples);

/// Computes it. Averages along 16 directions with a Gaussian such that the whole filter has the SD `along` px
/// (or that of the level, if greater). The ground is the local RMS of the response *across* the strongest
/// direction: texture responds alike in all directions, a curve does not raise its own ground. It is at least
/// what white noise of SD `noise` gives. `usual`: the median response across, of a greater frame of which
/// this is a part; 0: it is measured. O(pixels · directions · taps).
OrientedResponse compute_oriented_response(const ScaleLevel& level, Derivative order, double along,
                                           double noise, double usual = 0);

}  // namespace emberfold::sketch
