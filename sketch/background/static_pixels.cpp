// SPDX-License-Identifier: Apache-2.0
#include "sketch/background/static_pixels.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/context.hpp"
#include "core/model_arrays.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kNoiseLevels = 14;    // grey levels that noise may take a pixel off its mean
constexpr double kShake = 1.5;         // px: what a camera's shaking may take an edge off its place
constexpr double kRareShare = 0.01;    // of the frames in which it may be farther off
constexpr int kStillMargin = 2;        // px that have to be still about a pixel
constexpr std::int64_t kFrames = 240;  // number of evenly chosen frames

template <class Visit>
std::int64_t visit_frames(core::FrameSource& source, const core::Context& context, const Visit& visit) {
  const std::int64_t every = std::max<std::int64_t>(1, source.info().frames.value_or(0) / kFrames);
  std::int64_t count = 0;
  source.rewind();
  cv::Mat frame = source.next();
  for (std::int64_t t = 0; !frame.empty(); frame = source.next(), ++t) {
    context.check();
    if (t % every != 0) continue;
    visit(core::to_levels(frame, source.info()));
    ++count;
  }
  return count;
}

/// Largest deviation of each value from its mean through noise and shaking.
cv::Mat allowed_deviation(const cv::Mat& mean) {
  cv::Mat along_x, along_y, slope;
  cv::Sobel(mean, along_x, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(mean, along_y, CV_32F, 0, 1, 3, 0.125);
  cv::sqrt(along_x.mul(along_x) + along_y.mul(along_y), slope);
  return cv::Mat(slope * kShake + cv::Scalar::all(kNoiseLevels));
}

/// 1 where any channel is set.
cv::Mat any_channel(const cv::Mat& set) {
  cv::Mat greatest;
  cv::reduce(set.reshape(1, static_cast<int>(set.total())), greatest, 1, cv::REDUCE_MAX);
  return cv::Mat(greatest.reshape(1, set.rows) / 255);
}

}  // namespace

StaticPixels find_static_pixels(core::FrameSource& source, const core::Context& context) {
  cv::Mat sum;
  const auto count = visit_frames(source, context, [&](const cv::Mat& levels) {
    if (sum.empty()) sum = cv::Mat::zeros(levels.size(), CV_64FC(levels.channels()));
    cv::accumulate(levels, sum);
  });
  if (count == 0) return {};
  cv::Mat mean, off, times = cv::Mat::zeros(sum.size(), CV_16U);
  sum.convertTo(mean, CV_32F, 1 / static_cast<double>(count));
  const cv::Mat allowed = allowed_deviation(mean);
  visit_frames(source, context, [&](const cv::Mat& levels) {
    cv::absdiff(levels, mean, off);
    cv::add(times, any_channel(off > allowed), times, cv::noArray(), CV_16U);
  });
  StaticPixels result;
  const int side = 2 * kStillMargin + 1;
  cv::erode(times <= kRareShare * static_cast<double>(count), result.still, cv::Mat::ones(side, side, CV_8U));
  result.levels = cv::Mat::zeros(mean.size(), CV_8UC(mean.channels()));
  mean.convertTo(off, CV_8U);
  off.copyTo(result.levels, result.still);
  return result;
}

void add_static_pixels(core::ModelArchive& archive, const StaticPixels& result) {
  if (result.empty()) return;
  archive.arrays["backdrop"] = core::byte_array(result.levels);
  archive.arrays["backdrop_still"] = core::byte_array(result.still);
}

StaticPixels read_static_pixels(const core::ModelArchive& archive, cv::Size frame) {
  if (!archive.arrays.contains("backdrop") && !archive.arrays.contains("backdrop_still")) return {};
  StaticPixels result{core::read_bytes(archive, "backdrop", frame, core::channels_of(archive, "backdrop")),
                      core::read_bytes(archive, "backdrop_still", frame, 1)};
  result.still = result.still != 0;
  return result;
}

}  // namespace emberfold::sketch
