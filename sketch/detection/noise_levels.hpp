// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

/// Holds the SD of the second (lines) and first (steps) derivatives on structureless ground, for each level.
struct NoiseLevels {
  std::vector<double> second, first;
};

/// Tells which part of a frame a scale space is of.
struct FramePart {
  cv::Size frame;
  cv::Point origin;  ///< of the part in the frame
  cv::Rect core;     ///< of the frame: where the part is asked, not its neighbours
};
/// Returns the part that is all.
inline FramePart whole_frame(cv::Size frame) {
  return {frame, {0, 0}, {{0, 0}, frame}};
}

/// Holds sizes of derivatives at places that lie evenly over a frame; for each level.
struct DerivativeSamples {
  std::vector<std::vector<float>> second, first;
};
/// Adds those of a part; together the parts' samples are those of the whole frame.
void add_samples(const ScaleSpace& space, const FramePart& part, DerivativeSamples& samples);
/// Measures the noise of the levels from their samples; see below. `space`: of any part; `noise`: of each
/// channel.
NoiseLevels measure_noise_levels(DerivativeSamples samples, const ScaleSpace& space,
                                 std::span<const double> noise);
/// Measures the noise of each level. `noise`: SD of the white noise in grey levels. Ground that is textured
/// or has correlated noise responds more than white noise; the level's own median response counts then.
NoiseLevels measure_noise_levels(const ScaleSpace& space, double noise);

}  // namespace emberfold::sketch
