// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>

// Frames in square cells of `cell` px; the last cells of a row or column may reach beyond the frame.
namespace emberfold::core {

/// Returns how many cells cover the frame, along x and y.
inline cv::Size count_cells(cv::Size frame, int cell) {
  return {(frame.width + cell - 1) / cell, (frame.height + cell - 1) / cell};
}

/// Returns the size of the whole cells that cover the frame, px.
inline cv::Size whole_cells(cv::Size frame, int cell) {
  return count_cells(frame, cell) * cell;
}

/// Returns the frame continued to whole cells by repeating its border.
inline cv::Mat pad_to_cells(const cv::Mat& values, int cell) {
  const cv::Size whole = whole_cells(values.size(), cell);
  cv::Mat padded;
  cv::copyMakeBorder(values, padded, 0, whole.height - values.rows, 0, whole.width - values.cols,
                     cv::BORDER_REPLICATE);
  return padded;
}

/// Returns each cell's mean over its pixels, those beyond the frame as at its border.
inline cv::Mat cell_means(const cv::Mat& values, int cell) {
  cv::Mat means;
  cv::resize(pad_to_cells(values, cell), means, count_cells(values.size(), cell), 0, 0, cv::INTER_AREA);
  return means;
}

/// Returns a value for every pixel of the whole cells: linear between the cells' middles, or, with
/// `interpolation` cv::INTER_NEAREST, the cell's own.
inline cv::Mat spread_cells(const cv::Mat& cells, int cell, int interpolation = cv::INTER_LINEAR) {
  cv::Mat values;
  cv::resize(cells, values, cells.size() * cell, 0, 0, interpolation);
  return values;
}

}  // namespace emberfold::core
