// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A matrix to be drawn. `values`: CV_64F, of as many rows and columns as there are names; what is not finite
/// is hatched.
struct HeatMatrix {
  std::string title;
  std::vector<std::string> names;  ///< of rows and columns
  cv::Mat values;
  bool log_colours = false;  ///< colours by the logarithm of what is above 0
  bool whole = false;        ///< numbers without decimals
  int widest = 1400;         ///< px, of the cells together
};

/// Dark is large. Numbers stand in the cells where they have room; names beside the rows and, turned, above
/// the columns. CV_8UC3.
cv::Mat draw_heat_matrix(const HeatMatrix& matrix);

}  // namespace emberfold::apps
