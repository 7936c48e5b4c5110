// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/level_range.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/math/cell_grid.hpp"
#include "core/math/luma.hpp"
#include "core/model_arrays.hpp"
#include "sketch/background/level_clamp.hpp"

namespace emberfold::sketch {

namespace {

/// The least or the greatest value about each cell, in its north-western pixel: within a cell's length of its
/// middle, so that what lies between two middles counts for both.
cv::Mat cell_extremes(const cv::Mat& whole, bool least) {
  constexpr int half_cell = kLevelRangeCell / 2;
  const cv::Mat window = cv::Mat::ones(2 * kLevelRangeCell, 2 * kLevelRangeCell, CV_8U);
  cv::Mat wide, all, result;
  cv::copyMakeBorder(whole, wide, half_cell, half_cell, half_cell, half_cell, cv::BORDER_REPLICATE);
  (least ? cv::erode : cv::dilate)(wide, all, window, {0, 0}, 1, cv::BORDER_REPLICATE,
                                   cv::morphologyDefaultBorderValue());
  all = all(cv::Rect({0, 0}, whole.size()));
  cv::resize(all, result, {whole.cols / kLevelRangeCell, whole.rows / kLevelRangeCell}, 0, 0,
             cv::INTER_NEAREST);
  return result;
}

}  // namespace

LevelRange measure_level_range(const cv::Mat& levels) {
  cv::Mat bytes;
  levels.convertTo(bytes, CV_8U);
  const cv::Mat whole = core::pad_to_cells(bytes, kLevelRangeCell);
  return {cell_extremes(whole, true), cell_extremes(whole, false)};
}

void extend_level_range(LevelRange& all, const LevelRange& more) {
  if (more.empty()) return;
  if (all.empty()) {
    all = {more.low.clone(), more.high.clone()};
    return;
  }
  cv::min(all.low, more.low, all.low);
  cv::max(all.high, more.high, all.high);
}

graph::AttributeGraph clamp_levels(const graph::AttributeGraph& graph, const LevelRange& range) {
  if (range.empty()) return graph;
  const cv::Mat low = range.low.isContinuous() ? range.low : range.low.clone();
  const cv::Mat high = range.high.isContinuous() ? range.high : range.high.clone();
  return clamp_levels(graph, LevelCells{low.cols, low.rows, low.channels(), low.ptr(), high.ptr()});
}

void add_level_range(core::ModelArchive& archive, const LevelRange& range) {
  if (range.empty()) return;
  archive.arrays["seen_low"] = core::byte_array(range.low);
  archive.arrays["seen_high"] = core::byte_array(range.high);
}

LevelRange read_level_range(const core::ModelArchive& archive, cv::Size frame) {
  if (!archive.arrays.contains("seen_low") && !archive.arrays.contains("seen_high")) return {};
  const int channels = core::channels_of(archive, "seen_low");
  const cv::Size cells = core::count_cells(frame, kLevelRangeCell);
  LevelRange range{core::read_bytes(archive, "seen_low", cells, channels),
                   core::read_bytes(archive, "seen_high", cells, channels)};
  for (std::size_t i = 0; i < range.low.total() * range.low.elemSize(); ++i)
    if (range.low.data[i] > range.high.data[i])
      throw core::IoError("motion model: seen_low.npy lies above seen_high.npy in a cell");
  return range;
}

}  // namespace emberfold::sketch
