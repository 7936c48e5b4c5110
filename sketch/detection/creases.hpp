// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/detection/noise_levels.hpp"
#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

/// Kind of a crease.
enum class CreaseKind : std::uint8_t { ridge, valley, step };

/// Holds a pixel through which a crease runs, with the crease's subpixel place.
struct CreasePoint {
  graph::Point position;
  double theta = 0;         ///< rad, undirected; of a step the brighter side is on the right
  double significance = 0;  ///< response in SD of the noise's response
  double strength = 0;      ///< scale-normalised, comparable between scales (Lindeberg 1998)
  double contrast = 0;  ///< grey levels ≥ 0, of a line or step of the size that responds best at this scale
  int level = 0;        ///< of the scale space
  double evidence = 0;  ///< nats that speak for a crease here, against texture
};

/// Holds all crease points of one kind, at most one a pixel.
struct CreaseMap {
  CreaseKind kind = CreaseKind::ridge;
  std::vector<CreasePoint> points;
  cv::Mat1i index;  ///< of the point in a pixel, −1 where there is none
};

/// Returns the index of a map without points.
cv::Mat1i make_empty_index(cv::Size frame);

/// Holds the thresholds of crease points.
struct CreaseLimits {
  double significance;  ///< points below it are left out
  double contrast;      ///< grey levels, likewise
};

/// Holds the lines of both signs.
struct CreaseLines {
  CreaseMap ridges, valleys;
};
/// Finds line points: pixels inside which the first derivative across the direction of greatest curvature
/// vanishes (Steger 1998). The scale is that of the greatest normalised second derivative (Lindeberg 1998, γ
/// = 3/4). O(pixels · levels).
CreaseLines find_lines(const ScaleSpace& space, const NoiseLevels& ground, CreaseLimits limits);

/// Finds step points: pixels at which the gradient's magnitude is greatest along its own direction. The scale
/// is that of the greatest normalised gradient (γ = 1/2). O(pixels · levels).
CreaseMap find_steps(const ScaleSpace& space, const NoiseLevels& ground, CreaseLimits limits);

/// Removes the weak counter-lobes of opposite sign around stronger lines.
void remove_lobes(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space);
/// Removes the two steps on the flanks of lines: those of less than `of_flank` times the contrast that the
/// steepest slope of a Gaussian line shows as a step. A line whose sides differ by half has one flank that is
/// a third higher.
void remove_flanks(CreaseMap& steps, const CreaseMap& lines, const ScaleSpace& space, double of_flank);
/// Removes lines on which a stronger line of opposite sign runs, in another channel.
void remove_coinciding(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space);

/// Keeps the strongest of parallel points that are nearer than two lines of their size can be resolved.
void thin_parallel_points(CreaseMap& map, const ScaleSpace& space);

}  // namespace emberfold::sketch
