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
#include "sketch/rendering/curve_bands.hpp"

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

/// Linear between the middles of cells; the outermost go on.
double interpolate_cells(const cv::Mat& values, graph::Point place, int channel) {
  const auto along = [](double p, int count) {
    const double cell = std::clamp((p + 0.5) / kLevelRangeCell - 0.5, 0.0, count - 1.0);
    const int first = std::min(static_cast<int>(cell), std::max(0, count - 2));
    return std::pair{first, cell - first};
  };
  const auto [x, u] = along(place.x, values.cols);
  const auto [y, v] = along(place.y, values.rows);
  const int right = std::min(x + 1, values.cols - 1), below = std::min(y + 1, values.rows - 1);
  const auto value = [&](int column, int row) {
    return static_cast<double>(values.ptr(row)[column * values.channels() + channel]);
  };
  return (1 - v) * ((1 - u) * value(x, y) + u * value(right, y)) +
         v * ((1 - u) * value(x, below) + u * value(right, below));
}

double luma(const graph::Level& level) {
  return core::luma(double{level[0]}, double{level[1]}, double{level[2]});
}

double clamp_level(double level, const LevelRange& range, graph::Point place, int channel) {
  return std::clamp(level, interpolate_cells(range.low, place, channel),
                    interpolate_cells(range.high, place, channel));
}

/// Share of a line's contrast that is visible; the blur takes the rest.
double visible_share(const graph::Patch& patch) {
  return std::erf(patch.width / (2 * std::numbers::sqrt2 * std::max(patch.blur, sketch::kLeastBlur)));
}

void clamp_patch(graph::Patch& patch, const LevelRange& range) {
  const graph::Point aside =
      graph::Point{-std::sin(patch.theta), std::cos(patch.theta)} * sketch::profile_reach(patch);
  const bool step = graph::on_step(patch);
  const double share = visible_share(patch), before = luma(patch.right) - luma(patch.left);
  for (std::size_t c = 0; c < patch.left.size(); ++c) {
    const int channel = std::min(static_cast<int>(c), range.low.channels() - 1);
    const double height = double{patch.middle[c]} - (double{patch.left[c]} + double{patch.right[c]}) / 2;
    const double left = clamp_level(double{patch.left[c]}, range, patch.position - aside, channel),
                 right = clamp_level(double{patch.right[c]}, range, patch.position + aside, channel),
                 sides = (left + right) / 2;
    const double core =
        step ? 0 : clamp_level(sides + share * height, range, patch.position, channel) - sides;
    patch.left[c] = static_cast<float>(left), patch.right[c] = static_cast<float>(right);
    patch.middle[c] = static_cast<float>(step || share < 1e-3 ? sides : sides + core / share);
  }
  const double after = luma(patch.right) - luma(patch.left);
  if (step && before != after) patch.contrast = after;
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
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (auto& vertex : vertices) clamp_patch(vertex.patch, range);
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
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
