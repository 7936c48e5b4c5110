// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::apps {

/// A square matrix with names. `values`: CV_64F, a row and a column for each name; non-finite cells are
/// hatched.
struct HeatMatrix {
  std::string title;
  std::vector<std::string> names;  ///< of rows and columns
  cv::Mat values;
  bool log_colours = false;  ///< colours by the logarithm of positive values
  bool whole = false;        ///< numbers without decimals
  int widest = 1400;         ///< px, of the cells together
};

/// Draws a matrix, large values dark, CV_8UC3.
/// Numbers are in cells with enough room, names next to the rows and, rotated, above the columns.
cv::Mat draw_heat_matrix(const HeatMatrix& matrix);

}  // namespace emberfold::apps
