// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// One curve of a plot.
struct Curve {
  std::string name;
  std::vector<double> x,
      y;                ///< of one length; points that are not finite, or ≤ 0 on a log axis, are left out
  bool points = false;  ///< also a dot at every point
  int colour = -1;      ///< 0…5; −1: by its index among the curves
};

/// Curves and the labels of their axes.
struct CurvePlot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool log_x = false, log_y = false;
};

/// Draws curves with axes, grid and legend, 900 × 540 px, CV_8UC3. The legend is in the corner where it hides
/// least.
cv::Mat draw_curves(const CurvePlot& plot);

}  // namespace emberfold::apps
