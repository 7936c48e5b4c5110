// SPDX-License-Identifier: Apache-2.0
#include "apps/ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"

namespace emberfold::apps {

namespace {

constexpr double beside = 8;        // px about a patch that are not ground
constexpr double seen_share = 0.2;  // of the frames
constexpr double restless = 8;      // levels, SD over the frames, beyond which a ground is not still
constexpr double away = 12;         // px from all patches, from where on the ground is held

cv::Size cells(cv::Size frame) {
  return {(frame.width + kGroundCell - 1) / kGroundCell, (frame.height + kGroundCell - 1) / kGroundCell};
}

// One value a cell spread over the frame: linear between still cells, which alone count.
cv::Mat spread_out(const Ground& ground, cv::Size frame) {
  cv::Mat weight, weights, levels;
  ground.still.convertTo(weight, CV_32F, 1 / 255.0);
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(ground.levels.channels()), weight), weights);
  const cv::Size whole(ground.levels.cols * kGroundCell, ground.levels.rows * kGroundCell);
  cv::resize(ground.levels.mul(weights), levels, whole, 0, 0, cv::INTER_LINEAR);
  cv::resize(weights, weights, whole, 0, 0, cv::INTER_LINEAR);
  levels /= cv::max(weights, 1e-3);
  return levels(cv::Rect({0, 0}, frame)).clone();
}

/// The distance from what the mask shows, px, of what is there in part as if it were farther off. A chamfer
/// of two passes (Borgefors 1986, as OpenCV's DIST_MASK_3).
cv::Mat way_off(const cv::Mat& mask, const cv::Mat& presence) {
  constexpr float straight = 0.955F, aslant = 1.3693F, far = 1e6F;
  const int rows = mask.rows, columns = mask.cols;
  cv::Mat distance(rows + 2, columns + 2, CV_32F, cv::Scalar(far));
  for (int y = 0; y < rows; ++y) {
    float* line = distance.ptr<float>(y + 1) + 1;
    for (int x = 0; x < columns; ++x)
      if (mask.at<uchar>(y, x) != 0)
        line[x] = presence.empty() ? 0 : static_cast<float>(away) * (1 - presence.at<float>(y, x));
  }
  for (int y = 1; y <= rows; ++y) {
    const float* above = distance.ptr<float>(y - 1);
    float* line = distance.ptr<float>(y);
    for (int x = 1; x <= columns; ++x)
      line[x] = std::min({line[x], line[x - 1] + straight, above[x] + straight,
                          std::min(above[x - 1], above[x + 1]) + aslant});
  }
  for (int y = rows; y >= 1; --y) {
    const float* below = distance.ptr<float>(y + 1);
    float* line = distance.ptr<float>(y);
    for (int x = columns; x >= 1; --x)
      line[x] = std::min({line[x], line[x + 1] + straight, below[x] + straight,
                          std::min(below[x - 1], below[x + 1]) + aslant});
  }
  return distance(cv::Rect(1, 1, columns, rows));
}

cv::Mat with_channels(const cv::Mat& levels, int channels) {
  if (levels.channels() == channels) return levels;
  if (channels == 1) return core::luma(levels);
  cv::Mat colour;
  cv::cvtColor(levels, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

std::string shape_of(const core::NpyArray& array) {
  std::string text;
  for (const auto size : array.shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw core::IoError("motion model: " + name + ".npy " + why);
}

}  // namespace

FrameGround measure_ground(const cv::Mat& levels, const graph::AttributeGraph& graph) {
  const cv::Size size = cells(levels.size());
  cv::Mat whole;
  cv::copyMakeBorder(levels, whole, 0, size.height * kGroundCell - levels.rows, 0,
                     size.width * kGroundCell - levels.cols, cv::BORDER_REPLICATE);
  FrameGround ground{{}, cv::Mat(size, CV_8U, cv::Scalar(255)), measure_seen(levels)};
  cv::resize(whole, ground.levels, size, 0, 0, cv::INTER_AREA);
  const auto cell = [](double at, int count) {
    return std::clamp(static_cast<int>(std::floor((at + 0.5) / kGroundCell)), 0, count - 1);
  };
  for (const auto& vertex : graph.vertices()) {
    const auto [x, y] = vertex.patch.position;
    for (int row = cell(y - beside, size.height); row <= cell(y + beside, size.height); ++row)
      for (int column = cell(x - beside, size.width); column <= cell(x + beside, size.width); ++column)
        ground.open.at<uchar>(row, column) = 0;
  }
  return ground;
}

Ground still_ground(std::span<const FrameGround> frames) {
  const cv::Mat& like = frames[0].levels;
  const int channels = like.channels();
  cv::Mat count = cv::Mat::zeros(like.size(), CV_64F), sum = cv::Mat::zeros(like.size(), CV_64FC(channels)),
          squares = sum.clone();
  for (const auto& frame : frames) {
    cv::Mat levels, open, opens;
    frame.levels.convertTo(levels, CV_64F);
    frame.open.convertTo(open, CV_64F, 1 / 255.0);
    cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(channels), open), opens);
    count += open;
    sum += levels.mul(opens);
    squares += levels.mul(levels).mul(opens);
  }
  Ground ground{cv::Mat::zeros(like.size(), CV_32FC(channels)), cv::Mat::zeros(like.size(), CV_8U)};
  for (const auto& frame : frames) add_seen(ground.seen, frame.seen);
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
        ground.levels.ptr<float>(y)[x * channels + c] = static_cast<float>(mean);
      }
      if (still) ground.still.at<uchar>(y, x) = 255;
    }
  return ground;
}

sketch::Sketchable with_ground(const sketch::Sketchable& part, const Ground& ground,
                               const cv::Mat& presence) {
  if (ground.empty()) return part;
  cv::Mat still;
  cv::resize(ground.still, still, {ground.still.cols * kGroundCell, ground.still.rows * kGroundCell}, 0, 0,
             cv::INTER_NEAREST);
  still = still(cv::Rect({0, 0}, part.mask.size())).clone();
  still.setTo(0, way_off(part.mask, presence) <= away);
  still.setTo(0, part.mask);
  const Ground fitting{with_channels(ground.levels, part.levels.channels()), ground.still};
  sketch::Sketchable held{part.levels.clone(), part.mask.clone()};
  spread_out(fitting, part.levels.size()).copyTo(held.levels, still);
  held.mask.setTo(255, still);
  if (!ground.backdrop.empty()) {
    cv::Mat levels;
    ground.backdrop.levels.convertTo(levels, CV_32F);
    with_channels(levels, part.levels.channels()).copyTo(held.levels, ground.backdrop.still);
    held.mask.setTo(255, ground.backdrop.still);
  }
  return held;
}

void add_ground(core::ModelArchive& archive, const Ground& ground) {
  add_seen_levels(archive, ground.seen);
  add_backdrop(archive, ground.backdrop);
  if (ground.empty()) return;
  const auto rows = static_cast<std::size_t>(ground.levels.rows),
             columns = static_cast<std::size_t>(ground.levels.cols),
             channels = static_cast<std::size_t>(ground.levels.channels());
  const cv::Mat levels = ground.levels.clone(), still = ground.still.clone();
  const auto* const values = levels.ptr<float>();
  archive.arrays["ground"] = {
      {rows, columns, channels}, false, std::vector<float>(values, values + rows * columns * channels)};
  archive.arrays["ground_still"] = {
      {rows, columns}, false, std::vector<std::uint8_t>(still.begin<uchar>(), still.end<uchar>())};
}

Ground read_ground(const core::ModelArchive& archive, cv::Size frame) {
  const auto levels = archive.arrays.find("ground"), still = archive.arrays.find("ground_still");
  if (levels == archive.arrays.end() && still == archive.arrays.end()) return {};
  if (levels == archive.arrays.end()) refuse("ground", "is missing");
  if (still == archive.arrays.end()) refuse("ground_still", "is missing");
  const cv::Size size = cells(frame);
  const auto rows = static_cast<std::size_t>(size.height), columns = static_cast<std::size_t>(size.width);
  const auto& shape = levels->second.shape;
  const auto* const values = std::get_if<std::vector<float>>(&levels->second.data);
  if (!values || levels->second.fortran_order || shape.size() != 3 || shape[0] != rows ||
      shape[1] != columns || (shape[2] != 1 && shape[2] != 3))
    refuse("ground", "is " + shape_of(levels->second) + "; expected float32, " + std::to_string(rows) +
                         " x " + std::to_string(columns) + " x 1 or 3");
  for (const float value : *values)
    if (!(std::abs(value) <= 1e6F)) refuse("ground", "holds a number that is not finite or out of range");
  const auto* const flags = std::get_if<std::vector<std::uint8_t>>(&still->second.data);
  if (!flags || still->second.fortran_order || still->second.shape != std::vector<std::size_t>{rows, columns})
    refuse("ground_still", "is " + shape_of(still->second) + "; expected uint8, " + std::to_string(rows) +
                               " x " + std::to_string(columns));
  const int channels = static_cast<int>(shape[2]);
  Ground ground{cv::Mat(size, CV_32FC(channels)), cv::Mat(size, CV_8U)};
  std::copy(values->begin(), values->end(), ground.levels.ptr<float>());
  std::ranges::transform(*flags, ground.still.begin<uchar>(),
                         [](std::uint8_t flag) { return flag ? 255 : 0; });
  ground.seen = read_seen_levels(archive, frame);
  ground.backdrop = read_backdrop(archive, frame);
  return ground;
}

}  // namespace emberfold::apps
