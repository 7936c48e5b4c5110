// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/still_background.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/math/cell_grid.hpp"
#include "core/model_arrays.hpp"
#include "sketch/background/level_range.hpp"
#include "sketch/background/patch_distance.hpp"
#include "sketch/background/static_pixels.hpp"

namespace emberfold::sketch {

namespace {

constexpr double beside = 8;        // px about a patch that are not ground
constexpr double seen_share = 0.2;  // of the frames
constexpr double restless = 8;      // levels, SD over the frames, beyond which a ground is not still
constexpr double soft = 6;          // px of a backdrop's edge over which strokes pass behind it

// One value a cell spread over the frame: linear between still cells, which alone count.
cv::Mat spread_still_cells(const Background& background, cv::Size frame) {
  cv::Mat weight, weights, levels;
  background.still.convertTo(weight, CV_32F, 1 / 255.0);
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(background.levels.channels()), weight), weights);
  levels = core::spread_cells(background.levels.mul(weights), kBackgroundCell);
  weights = core::spread_cells(weights, kBackgroundCell);
  levels /= cv::max(weights, 1e-3);
  return levels(cv::Rect({0, 0}, frame)).clone();
}

cv::Mat patch_distances(const cv::Mat& mask, const cv::Mat& opacity) {
  const cv::Mat shown = mask.isContinuous() ? mask : mask.clone();
  const cv::Mat present = opacity.isContinuous() ? opacity : opacity.clone();
  cv::Mat distance(mask.size(), CV_32F);
  distance_from_patches(mask.size(), shown.ptr(), present.empty() ? nullptr : present.ptr<float>(),
                        distance.ptr<float>());
  return distance;
}

cv::Mat with_channels(const cv::Mat& levels, int channels) {
  if (levels.channels() == channels) return levels;
  if (channels == 1) return core::luma(levels);
  cv::Mat colour;
  cv::cvtColor(levels, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace

FrameBackground measure_background(const cv::Mat& levels, const graph::AttributeGraph& graph) {
  const cv::Size size = core::count_cells(levels.size(), kBackgroundCell);
  FrameBackground background{core::cell_means(levels, kBackgroundCell), cv::Mat(size, CV_8U, cv::Scalar(255)),
                             measure_level_range(levels)};
  const auto cell = [](double at, int count) {
    return std::clamp(static_cast<int>(std::floor((at + 0.5) / kBackgroundCell)), 0, count - 1);
  };
  const graph::AttributeGraph strokes = graph::without_anchors(graph);
  for (const auto& vertex : strokes.vertices()) {
    const auto [x, y] = vertex.patch.position;
    for (int row = cell(y - beside, size.height); row <= cell(y + beside, size.height); ++row)
      for (int column = cell(x - beside, size.width); column <= cell(x + beside, size.width); ++column)
        background.uncovered.at<uchar>(row, column) = 0;
  }
  return background;
}

Background estimate_background(std::span<const FrameBackground> frames) {
  const cv::Mat& like = frames[0].levels;
  const int channels = like.channels();
  cv::Mat count = cv::Mat::zeros(like.size(), CV_64F), sum = cv::Mat::zeros(like.size(), CV_64FC(channels)),
          squares = sum.clone();
  for (const auto& frame : frames) {
    cv::Mat levels, uncovered, opens;
    frame.levels.convertTo(levels, CV_64F);
    frame.uncovered.convertTo(uncovered, CV_64F, 1 / 255.0);
    cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(channels), uncovered), opens);
    count += uncovered;
    sum += levels.mul(opens);
    squares += levels.mul(levels).mul(opens);
  }
  Background background{cv::Mat::zeros(like.size(), CV_32FC(channels)), cv::Mat::zeros(like.size(), CV_8U)};
  for (const auto& frame : frames) extend_level_range(background.level_range, frame.level_range);
  const double enough = std::max(1.0, seen_share * static_cast<double>(frames.size()));
  for (int y = 0; y < like.rows; ++y)
    for (int x = 0; x < like.cols; ++x) {
      const double n = count.at<double>(y, x);
      if (n < enough) continue;
      bool still = true;
      for (int c = 0; c < channels; ++c) {
        const double mean = sum.ptr<double>(y)[x * channels + c] / n;
        const double variance = squares.ptr<double>(y)[x * channels + c] / n - mean * mean;
        still = still && variance < restless * restless;
        background.levels.ptr<float>(y)[x * channels + c] = static_cast<float>(mean);
      }
      if (still) background.still.at<uchar>(y, x) = 255;
    }
  return background;
}

BackgroundImage expand_background(const Background& background, cv::Size frame, int channels) {
  const bool fixed = !background.static_pixels.empty();
  if (background.empty() || (!fixed && cv::countNonZero(background.still) == 0)) return {};
  const Background fitting{with_channels(background.levels, channels), background.still};
  const cv::Mat still = core::spread_cells(background.still, kBackgroundCell, cv::INTER_NEAREST);
  BackgroundImage whole{spread_still_cells(fitting, frame), still(cv::Rect({0, 0}, frame)).clone()};
  if (fixed) {
    cv::Mat levels;
    background.static_pixels.levels.convertTo(levels, CV_32F);
    with_channels(levels, channels).copyTo(whole.levels, background.static_pixels.still);
    cv::Mat inside;
    cv::distanceTransform(background.static_pixels.still, inside, cv::DIST_L2, 3);
    whole.share = cv::min(inside / soft, 1.0);
    whole.fixed = whole.share >= 1;
  }
  return whole;
}

sketch::Sketchable add_background_pixels(const sketch::Sketchable& part, const BackgroundImage& background,
                                         const cv::Mat& opacity) {
  if (background.empty()) return part;
  cv::Mat still = background.still & (patch_distances(part.mask, opacity) > kBackgroundDistance) & ~part.mask;
  if (!background.fixed.empty()) still |= background.fixed;
  sketch::Sketchable held{part.levels.clone(), part.mask | still};
  background.levels.copyTo(held.levels, still);
  return held;
}

void paste_static_pixels(cv::Mat& levels, const BackgroundImage& background) {
  const int channels = levels.channels();
  for (int y = 0; y < background.share.rows; ++y) {
    const auto *share = background.share.ptr<float>(y), *behind = background.levels.ptr<float>(y);
    auto* drawn = levels.ptr<float>(y);
    for (int x = 0; x < background.share.cols; ++x)
      for (int c = x * channels; share[x] > 0 && c < (x + 1) * channels; ++c)
        drawn[c] += share[x] * (behind[c] - drawn[c]);
  }
}

cv::Mat spread_maximum(const cv::Mat& ranks) {
  constexpr int reach = static_cast<int>(kBackgroundDistance / double{kStraightStep});
  cv::Mat near = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_8U), greatest;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      const int diagonal = std::min(std::abs(x), std::abs(y)), rest = std::abs(std::abs(x) - std::abs(y));
      near.at<uchar>(y + reach, x + reach) =
          diagonal * double{kSlantedStep} + rest * double{kStraightStep} <= kBackgroundDistance ? 1 : 0;
    }
  cv::dilate(ranks, greatest, near);
  return greatest;
}

void add_background(core::ModelArchive& archive, const Background& background) {
  add_level_range(archive, background.level_range);
  add_static_pixels(archive, background.static_pixels);
  if (background.empty()) return;
  archive.arrays["ground"] = core::float_array(background.levels);
  archive.arrays["ground_still"] = core::byte_array(background.still);
}

Background read_background(const core::ModelArchive& archive, cv::Size frame) {
  if (!archive.arrays.contains("ground") && !archive.arrays.contains("ground_still")) return {};
  Background background{
      core::read_floats(archive, "ground", core::count_cells(frame, kBackgroundCell),
                        core::channels_of(archive, "ground")),
      core::read_bytes(archive, "ground_still", core::count_cells(frame, kBackgroundCell), 1)};
  background.still = background.still != 0;
  background.level_range = read_level_range(archive, frame);
  background.static_pixels = read_static_pixels(archive, frame);
  return background;
}

}  // namespace emberfold::sketch
