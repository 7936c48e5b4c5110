// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include <opencv2/core/mat.hpp>

#include "graph/patch.hpp"
#include "sketch/detection/colour.hpp"
#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds the line of one cut across a curve.
struct Rib {
  graph::Point position;  ///< on the curve
  graph::Point across;    ///< unit, to the right of the curve
  double weight = 1;      ///< > 0
};

/// Holds the settings of fit_patch().
struct FitOptions {
  double spread = 1;                      ///< px, SD of the profile, roughly
  bool moves = false;                     ///< the patch may move across the curve
  double noise = 0;                       ///< grey levels, SD of the pixels
  std::array<float, 3> axis = kLumaAxis;  ///< weights of blue, green, red by which the profile is seen
};

/// Fits a patch's levels, width, blur and contrast to the image by least squares.
/// Where the patch may move, its place across the curve is fitted, too. The image is averaged along the ribs.
/// The start is the best of a grid of blurred bars about the size of the scale, moved sideways;
/// Levenberg-Marquardt follows. So position and width are those of the profile, not those of the smoothed
/// image's crease, which moves towards the brighter side and widens (Steger 1998 corrects both by tables over
/// scale and asymmetry). The blur that interpolation between pixels adds, 1/6 px², is taken off. `at`: the
/// patch's position and theta. `levels`: CV_32F, 1 or 3 channels. Some 10 µs.
graph::Patch fit_patch(const cv::Mat& levels, graph::Point at, double theta, CreaseKind kind,
                       std::span<const Rib> ribs, const FitOptions& options);

/// Fits a straight patch of `length` px that stays where it is.
graph::Patch fit_patch(const cv::Mat& levels, graph::Point position, double theta, CreaseKind kind,
                       double spread, double length);

}  // namespace emberfold::sketch
