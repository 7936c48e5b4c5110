// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/detection/scale_space.hpp"

namespace emberfold::sketch {

enum class CreaseKind : std::uint8_t { ridge, valley, step };

/// A pixel through which a crease runs, with the crease's subpixel place.
struct CreasePoint {
  graph::Point position;
  double theta = 0;         ///< rad, undirected; a step's points so that the brighter side is on the right
  double significance = 0;  ///< response in SD of the ground's response
  double strength = 0;      ///< scale-normalised, comparable between scales (Lindeberg 1998)
  double contrast = 0;  ///< grey levels ≥ 0, of a line or step of the size that responds best at this scale
  int level = 0;        ///< of the scale space
};

/// All crease points of one kind, at most one a pixel.
struct CreaseMap {
  CreaseKind kind = CreaseKind::ridge;
  std::vector<CreasePoint> points;
  cv::Mat1i index;  ///< of the point in a pixel, −1 where there is none
};

/// The index of a map without points.
cv::Mat1i make_empty_index(cv::Size frame);

/// What counts as significant: SD of the second (lines) and first (steps) derivatives on structureless
/// ground, for each level.
struct NoiseLevels {
  std::vector<double> second, first;
};
/// `noise`: SD of the white noise in grey levels. Ground that is textured or has correlated noise responds
/// more: the levels' own median response tells.
NoiseLevels measure_noise_levels(const ScaleSpace& space, double noise);

struct CreaseLimits {
  double significance;  ///< points below it are left out
  double contrast;      ///< grey levels, likewise
};

/// Lines: where the first derivative across the direction of greatest curvature vanishes inside the pixel
/// (Steger 1998), at the scale where the normalised second derivative is greatest (Lindeberg 1998, γ = 3/4).
/// O(pixels · levels).
struct CreaseLines {
  CreaseMap ridges, valleys;
};
CreaseLines find_lines(const ScaleSpace& space, const NoiseLevels& ground, CreaseLimits limits);

/// Steps: where the gradient's magnitude is greatest along its own direction, at the scale where its
/// normalised value is greatest (γ = 1/2).
CreaseMap find_steps(const ScaleSpace& space, const NoiseLevels& ground, CreaseLimits limits);

/// Takes away what belongs to a stronger line: the weak counter-lobes of opposite sign around it, and the two
/// steps that its flanks are.
void remove_lobes(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space);
void remove_flanks(CreaseMap& steps, const CreaseMap& lines, const ScaleSpace& space);
/// Takes away lines on which a stronger line of opposite sign runs, in another channel.
void remove_coinciding(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space);

/// Of points that run in parallel nearer than lines of their size could be told apart, keeps the strongest.
void thin_parallel_points(CreaseMap& map, const ScaleSpace& space);

}  // namespace emberfold::sketch
